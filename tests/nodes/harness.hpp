// Drives one node by hand: builds the plain step data that a graph would, and collects and checks
// what comes out. Needs no graph, so that a test knows exactly what the node has seen.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "spikeloop/core/node.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/nodes/register.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::testing {

using test::Fault;

inline constexpr TimeNs kMs = 1'000'000;

/// The built-in class of that name.
inline NodeClass built_in(const std::string& name) {
  Registry registry;
  register_nodes(registry);
  return registry.find(name);
}

/// How a node under test is made: `keys` as a user writes them, `weights` in place of a file.
struct NodeOptions {
  std::map<std::string, std::string> keys{};
  std::optional<WeightTable> weights{};
  std::string weights_key = "weights";
  std::string name = "node";
  std::uint64_t seed = 1;
};

class NodeHarness {
 public:
  /// `widths` runs parallel to the class's ports.
  NodeHarness(NodeClass node_class, const std::vector<std::uint32_t>& widths,
              const NodeOptions& options = {})
      : class_(std::move(node_class)), node_(class_.create(setup(widths, options))) {
    for (std::size_t i = 0; i < widths.size(); ++i) {
      add_port(class_.description.ports[i], widths[i]);
    }
  }
  NodeHarness(const std::string& class_name, const std::vector<std::uint32_t>& widths,
              const NodeOptions& options = {})
      : NodeHarness(built_in(class_name), widths, options) {}

  /// A new revision of signal input `port`.
  void set_input(const std::vector<double>& values, std::size_t port = 0) {
    signal_inputs_[port].values = values;
    ++signal_inputs_[port].revision;
  }
  void invalidate_input(std::size_t port = 0) { signal_inputs_[port].revision = 0; }
  /// Hands a spike over in the next step, late or not.
  void add_spike(TimeNs time, std::int32_t channel, std::size_t port = 0) {
    spike_inputs_[port].spikes.push_back(make_spike(time, channel));
  }

  /// As Node::change().
  void change(std::string_view parameter, double value) { node_->change(parameter, value); }

  /// Advances by `length`; stamps outside the interval and unknown channels throw.
  void step(TimeNs length) {
    begin_ = end_;
    end_ += length;
    std::vector<spikeloop_signal_input> signal_in;
    for (const Signal& signal : signal_inputs_) {
      signal_in.push_back({signal.values.data(), signal.revision, signal.width, 0});
    }
    std::vector<spikeloop_spike_input> spike_in;
    for (Spikes& port : spike_inputs_) {
      std::sort(port.spikes.begin(), port.spikes.end(), spike_before);
      spike_in.push_back({port.spikes.data(), port.spikes.size(), port.width, 0});
    }
    std::vector<spikeloop_signal_output> signal_out;
    for (Signal& signal : signal_outputs_) {
      signal_out.push_back({signal.values.data(), signal.revision, signal.width, 0});
    }
    std::vector<spikeloop_spike_output> spike_out;
    for (Spikes& port : spike_outputs_) {
      port.interval = {begin_, end_};
      spike_out.push_back({&port, &Spikes::append, port.width, 0});
    }
    const spikeloop_step data{begin_,
                              end_,
                              signal_in.data(),
                              spike_in.data(),
                              signal_out.data(),
                              spike_out.data(),
                              static_cast<std::uint32_t>(signal_in.size()),
                              static_cast<std::uint32_t>(spike_in.size()),
                              static_cast<std::uint32_t>(signal_out.size()),
                              static_cast<std::uint32_t>(spike_out.size())};
    node_->step(Step(data));
    for (std::size_t i = 0; i < signal_outputs_.size(); ++i) {
      signal_outputs_[i].revision = signal_out[i].revision;
    }
    for (Spikes& port : spike_inputs_) {
      port.spikes.clear();
    }
  }
  /// Steps of `tick` until the clock shows `time`.
  void run_until(TimeNs time, TimeNs tick) {
    while (end_ < time) {
      step(std::min(tick, time - end_));
    }
  }

  TimeNs time() const { return end_; }
  const std::vector<double>& output(std::size_t port = 0) const {
    return signal_outputs_[port].values;
  }
  std::uint64_t revision(std::size_t port = 0) const { return signal_outputs_[port].revision; }
  /// All spikes so far, sorted by (time, channel).
  std::vector<Spike> spikes(std::size_t port = 0) const {
    std::vector<Spike> sorted = spike_outputs_[port].spikes;
    std::sort(sorted.begin(), sorted.end(), spike_before);
    return sorted;
  }
  /// Spike times of one channel so far, in the order in which they were emitted.
  std::vector<TimeNs> times(std::int32_t channel = 0, std::size_t port = 0) const {
    std::vector<TimeNs> times;
    for (const Spike& spike : spike_outputs_[port].spikes) {
      if (spike.channel == channel) {
        times.push_back(spike.time_ns);
      }
    }
    return times;
  }
  /// The spikes since the last call, in the order in which they were emitted.
  std::vector<Spike> take_spikes(std::size_t port = 0) {
    return std::exchange(spike_outputs_[port].spikes, {});
  }
  std::size_t spike_count(std::size_t port = 0) const { return spike_outputs_[port].spikes.size(); }

  std::uint64_t counter(const std::string& name) const {
    for (const Counter& counter : node_->counters()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    throw std::logic_error("no counter '" + name + "'");
  }

 private:
  struct Signal {
    std::vector<double> values;
    std::uint32_t width = 0;
    std::uint64_t revision = 0;
  };
  struct Spikes {
    std::vector<Spike> spikes;
    std::uint32_t width = 0;
    Interval interval{};

    static void append(void* self, const Spike* spikes, std::uint64_t count) {
      auto& port = *static_cast<Spikes*>(self);
      for (const Spike& spike : std::span(spikes, count)) {
        if (!port.interval.contains(spike.time_ns)) {
          throw std::logic_error("spike at " + std::to_string(spike.time_ns) + " ns outside (" +
                                 std::to_string(port.interval.begin) + ", " +
                                 std::to_string(port.interval.end) + "]");
        }
        if (spike.channel < 0 || static_cast<std::uint32_t>(spike.channel) >= port.width) {
          throw std::logic_error("spike on channel " + std::to_string(spike.channel));
        }
      }
      port.spikes.insert(port.spikes.end(), spikes, spikes + count);
    }
  };

  NodeSetup setup(const std::vector<std::uint32_t>& widths, const NodeOptions& options) const {
    WrittenValues written;
    for (const auto& [key, text] : options.keys) {
      written[key] = {text, {"test.yaml", 7, 3}};
    }
    if (options.weights) {
      written[options.weights_key] = {"weights.json", {"test.yaml", 8, 3}};
    }
    const auto load = [&](const WrittenValue& value) {
      return value.text == "uniform" ? WeightTable::uniform()
             : value.text == "even"  ? WeightTable::even()
                                     : options.weights.value();
    };
    return {options.name, options.seed, resolve(class_.description.parameters, written, load),
            widths};
  }

  void add_port(const PortDescription& port, std::uint32_t width) {
    if (port.kind == PortKind::signal) {
      auto& ports = port.direction == Direction::input ? signal_inputs_ : signal_outputs_;
      ports.push_back({std::vector<double>(width, 0.0), width, 0});
    } else {
      auto& ports = port.direction == Direction::input ? spike_inputs_ : spike_outputs_;
      ports.push_back({{}, width, {}});
    }
  }

  NodeClass class_;
  std::unique_ptr<Node> node_;
  TimeNs begin_ = 0;
  TimeNs end_ = 0;
  std::vector<Signal> signal_inputs_;
  std::vector<Signal> signal_outputs_;
  std::vector<Spikes> spike_inputs_;
  std::vector<Spikes> spike_outputs_;
};

/// The text of the exception that `action` ends with; fails the test when there is none.
template <typename Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace spikeloop::testing
