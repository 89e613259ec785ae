// What carries messages between the graph and the robot.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/command/command_feed.hpp"
#include "spikeloop/command/component_map.hpp"
#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

/// Ports: `command` [a value a field] and, `with_pace`, `pace` [1].
class CommandEnd : public Sink {
 public:
  /// Before the loop begins; as command::CommandFeed.
  virtual void on_latency(command::TakeLatency take) = 0;
  /// Zero, the last thing that leaves.
  virtual void stop(command::StopReason reason) = 0;
  /// commands, latency_median_ms, latency_p99_ms, age_max_ms.
  virtual nlohmann::json summary() const = 0;
};

struct CommandSpec {
  const experiment::Part& part;
  const command::ComponentMap& map;  ///< channels to fields
  bool with_pace = false;
  std::string from{};  ///< the output that drives it, "decoder.out"
};

class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// Ports: `out` [width] and `pace` [1].
  virtual std::unique_ptr<Source> sensor(const experiment::Part& part, std::uint32_t width) = 0;
  virtual std::unique_ptr<CommandEnd> command(const CommandSpec& spec) = 0;

  /// The clock shows `time`: before the graph steps.
  virtual void begin(TimeNs /*time*/) {}
  /// The graph has stepped to `time`.
  virtual void end(TimeNs /*time*/) {}
  /// Nothing more comes; files are closed.
  virtual void finish() {}
  /// collisions, distance_m, ... of a robot that it knows.
  virtual nlohmann::json summary() const { return nlohmann::json::object(); }
};

}  // namespace spikeloop::fused
