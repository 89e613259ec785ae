// Takes spikes, and fails in its second step, or already when it is made.
#include <spikeloop/core/plugin.hpp>
#include <stdexcept>

namespace {

using namespace spikeloop;

class Thrower : public Node {
 public:
  static NodeDescription describe() {
    return {.name = "thrower",
            .text = "Fails",
            .ports = {{.name = "in", .kind = PortKind::spikes, .text = "Spikes"}},
            .parameters = {{.name = "at_once",
                            .type = ParameterType::boolean,
                            .default_value = "false",
                            .text = "Fail when the node is made"}}};
  }
  explicit Thrower(const NodeSetup& setup) {
    if (setup.parameters.boolean("at_once")) {
      throw std::runtime_error("there is no battery");
    }
  }
  void step(const Step& step) override {
    if (step.interval().begin > 0) {
      throw std::runtime_error("the battery is empty");
    }
  }
};

}  // namespace

SPIKELOOP_PLUGIN(Thrower)
