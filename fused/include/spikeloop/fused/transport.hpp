// What carries messages between the graph and the robot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/command/command_feed.hpp"
#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/command/component_map.hpp"
#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

/// Ports: as command::CommandFeed.
class CommandEnd : public Sink {
 public:
  /// Before the loop begins; as command::CommandFeed.
  virtual void on_latency(command::TakeLatency take) = 0;
  /// Zero, the last thing that leaves.
  virtual void stop(command::StopReason reason) = 0;
  /// As command::CommandFeed's.
  virtual nlohmann::json summary() const = 0;
};

/// Keeps a message that a node took or sent, with the time at which it did: of a sensor the one at
/// which its tick begins, of a command the one at which it ends. Called in the loop's thread; may
/// be empty.
using Keep = std::function<void(TimeNs time, std::span<const std::byte> message)>;

struct SensorSpec {
  const experiment::Part& part;
  std::uint32_t width = 0;
  Keep keep{};  ///< every message, in order; what the last one makes of them is what the tick uses
};

struct CommandSpec {
  const experiment::Part& part;
  const command::ComponentMap& map;  ///< channels to fields
  bool with_pace = false;
  Keep keep{};
  std::string from{};                             ///< the output that drives it, "decoder.out"
  std::vector<command::WatchedSensor> sensors{};  ///< that it depends on
  std::vector<std::uint32_t> spike_widths{};      ///< of the spikes that are watched
  messages::Dialect ros = messages::Dialect::ros1;
};

/// Adds to a command's settings what its experiment says of bounds and of all that stops the robot.
void add_safety(const CommandSpec& spec, command::CommandSettings& settings);

class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// Of a ros_sensor or a ros_event_sensor. Ports: `out` [width] and `pace` [1].
  virtual std::unique_ptr<Source> sensor(const SensorSpec& spec) = 0;
  virtual std::unique_ptr<CommandEnd> command(const CommandSpec& spec) = 0;

  /// The robot's clock, with sync: sim_time; as all that waits here, it comes back when the run is
  /// to stop.
  virtual std::unique_ptr<Pacer> clock() { return nullptr; }
  /// The clock shows `time`: before the graph steps. May wait for the robot.
  virtual void begin(TimeNs /*time*/) {}
  /// The graph has stepped to `time`.
  virtual void end(TimeNs /*time*/) {}
  /// Nothing more comes; files are closed.
  virtual void finish() {}
  /// collisions, distance_m, ... of a robot that it knows.
  virtual nlohmann::json summary() const { return nlohmann::json::object(); }
};

}  // namespace spikeloop::fused
