// Node classes for tests, as a plug-in.
#include <stdexcept>

#include "spikeloop/core/plugin.hpp"

namespace spikeloop::test {

/// Every spike goes on, `delay` later.
class SpikeRelay : public Node {
 public:
  static NodeDescription describe() {
    return {"spike_relay",
            "Passes spikes on",
            "",
            {{"in", PortKind::spikes, Direction::input, {}, "Spikes"},
             {"out", PortKind::spikes, Direction::output, WidthRule::same_as(0), "The same"}},
            {{.name = "delay", .unit = "s", .default_value = "0", .text = "Added to every stamp"}}};
  }
  explicit SpikeRelay(const NodeSetup& setup)
      : delay_(from_seconds(setup.parameters.number("delay"))) {}
  void step(const Step& step) override {
    for (const Spike& spike : step.spike_input().spikes) {
      step.spike_output().emit(spike.time_ns + delay_, spike.channel);
    }
  }

 private:
  TimeNs delay_;
};

/// A signal goes on as it is; what is invalid stays invalid. Counts revisions.
class SignalRelay : public Node {
 public:
  static NodeDescription describe() {
    return {"signal_relay",
            "Passes a signal on",
            "",
            {{"in", PortKind::signal, Direction::input, {}, "A signal"},
             {"out", PortKind::signal, Direction::output, WidthRule::same_as(0), "The same"}},
            {}};
  }
  explicit SignalRelay(const NodeSetup&) {}
  void step(const Step& step) override {
    const auto input = step.signal_input();
    if (input.revision == revision_) {
      return;
    }
    revision_ = input.revision;
    ++revisions_;
    const auto output = step.signal_output();
    if (!input.valid()) {
      output.invalidate();
      return;
    }
    std::copy(input.values.begin(), input.values.end(), output.values().begin());
    output.commit();
  }
  std::vector<Counter> counters() const override { return {{"revisions", revisions_}}; }

 private:
  std::uint64_t revision_ = 0;
  std::uint64_t revisions_ = 0;
};

/// Spikes at both ends of every interval; throws at `fail_at`.
class EdgeSpiker : public Node {
 public:
  static NodeDescription describe() {
    return {"edge_spiker",
            "Spikes 1 ns after the begin and at the end of every interval",
            "",
            {{"out", PortKind::spikes, Direction::output, {}, "Channel 0: begin, channel 1: end"}},
            {{.name = "fail_at", .unit = "s", .default_value = "1000", .text = "When to throw"}}};
  }
  explicit EdgeSpiker(const NodeSetup& setup)
      : fail_at_(from_seconds(setup.parameters.number("fail_at"))) {}
  void step(const Step& step) override {
    if (step.interval().begin >= fail_at_) {
      throw std::runtime_error("the cell has burst");
    }
    step.spike_output().emit(step.interval().begin + 1, 0);
    step.spike_output().emit(step.interval().end, 1);
  }

 private:
  TimeNs fail_at_;
};

}  // namespace spikeloop::test

SPIKELOOP_PLUGIN(spikeloop::test::SpikeRelay, spikeloop::test::SignalRelay,
                 spikeloop::test::EdgeSpiker)
