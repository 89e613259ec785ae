// A network that cannot keep up: repeats every spike and takes `cost` of wall time a tick.
#include <chrono>
#include <thread>

#include "spikeloop/core/plugin.hpp"

namespace {

using namespace spikeloop;

class SlowRelay : public Node {
 public:
  static NodeDescription describe() {
    NodeDescription description;
    description.name = "slow_relay";
    description.text = "Repeats spikes at the end of their interval, slowly";
    description.ports = {
        {"in", PortKind::spikes, Direction::input, {}, "spikes"},
        {"out", PortKind::spikes, Direction::output, WidthRule::same_as(0), "the same"}};
    description.parameters = {{.name = "cost",
                               .unit = "s",
                               .default_value = "0.005",
                               .minimum = 0,
                               .maximum = 1,
                               .text = "wall time a tick"}};
    return description;
  }
  explicit SlowRelay(const NodeSetup& setup) : cost_(setup.parameters.number("cost")) {}

  void step(const Step& step) override {
    for (const Spike& spike : step.spike_input().spikes) {
      step.spike_output().emit(step.interval().end, spike.channel);
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(cost_));
  }

 private:
  double cost_;
};

}  // namespace

SPIKELOOP_PLUGIN(SlowRelay)
