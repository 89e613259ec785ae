#include <spikeloop/core/plugin.hpp>

namespace {

using namespace spikeloop;

class Doubler : public Node {
 public:
  static NodeDescription describe() {
    NodeDescription description;
    description.name = "doubler";
    description.text = "output = 2 * input";
    description.ports = {
        {"in", PortKind::signal, Direction::input, {}, "values"},
        {"out", PortKind::signal, Direction::output, WidthRule::same_as(0), "doubled values"}};
    return description;
  }
  explicit Doubler(const NodeSetup&) {}
  void step(const Step& step) override {
    const auto in = step.signal_input();
    if (!in.valid() || in.revision == seen_) {
      return;
    }
    seen_ = in.revision;
    for (std::size_t i = 0; i < in.values.size(); ++i) {
      step.signal_output().values()[i] = 2 * in.values[i];
    }
    step.signal_output().commit();
  }

 private:
  std::uint64_t seen_ = 0;
};

}  // namespace

SPIKELOOP_PLUGIN(Doubler)
