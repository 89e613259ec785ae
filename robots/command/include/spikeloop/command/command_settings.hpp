// All settings of a command, from its keys and its mapping.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/command/command_gate.hpp"
#include "spikeloop/command/limiter.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop::command {

/// Clock of deadbands, command rates and ages.
enum class CommandClock : std::uint8_t {
  wall,
  simulated,  ///< commands are sent in ticks only; the watchdog stays wall time
  /// As `simulated`, and the robot does not move between ticks: neither a missing tick nor SIGCONT
  /// stops the robot, and operator input takes effect at the next tick.
  lockstep
};

/// A sensor that a command depends on.
struct WatchedSensor {
  std::string topic;
  TimeNs timeout = 0;  ///< longest time without a message that has a reading; 0: unlimited
};

struct EmergencyStop {
  std::string topic{};  ///< empty if there is none
  std::string message_type = "std_msgs/Bool";
  std::string field = "data";  ///< path; any value but 0 stops the robot
  bool latched = false;        ///< the robot stays stopped until the end of the run
  bool required = false;       ///< the robot is stopped while the topic has no publisher
  TimeNs timeout = 0;          ///< longest wall time without a message; 0: unlimited

  bool operator==(const EmergencyStop&) const = default;
};

/// Manual commands. Their messages have the type of the commands.
struct Override {
  std::string topic{};           ///< empty if there is none
  TimeNs timeout = 500'000'000;  ///< validity of a manual command

  bool operator==(const Override&) const = default;
};

struct CommandSettings {
  std::string process{};  ///< name of the sending process in messages of the guard
  std::string node{};     ///< node in warnings; empty if warnings name the process
  std::string driver{};   ///< output that drives the command, "decoder.out"; empty if not known
  std::string topic{};
  std::string message_type{};
  std::vector<std::string> fields{};  ///< as in topics::Publisher
  bool with_data_stamp = false;
  GateSettings gate{};  ///< its deadbands: one per component
  TimeNs watchdog = 0;  ///< longest wall time without a tick
  TimeNs max_age = 0;   ///< maximum age of the data; 0: unlimited
  CommandClock clock = CommandClock::wall;
  std::vector<WatchedSensor> sensors{};
  std::vector<std::uint32_t> spike_widths{};  ///< channels of each port for spikes
  TimeNs spike_timeout = 0;      ///< longest time without a spike on any port; 0: unlimited
  std::vector<Bounds> bounds{};  ///< per component; if fewer, the others have none
  EmergencyStop emergency_stop{};
  Override manual{};
  std::vector<StopRule> stops{};  ///< per component; if fewer, the others are 0 at a stop
  std::string joint_states{};  ///< topic of the positions that a stop holds; empty if it holds none
  bool guard_required = false;  ///< the robot is stopped while no guard answers

  std::uint32_t width() const { return static_cast<std::uint32_t>(gate.deadband.size()); }
};

struct LoopClock {
  CommandClock clock = CommandClock::wall;
  TimeNs tick = 0;  ///< simulated duration of a tick
  double real_time_factor = 1;
};

/// Value of the key `limits` that disables the default limits. Limits of the mapping remain.
inline constexpr const char* kNoLimits = "none";

/// Settings from the mapping and the keys command_rate, deadband, limits, max_age, min_interval and
/// watchdog. By the wall clock min_interval is by default a tick, at least 10 ms, less half a
/// tick's jitter, and watchdog 3 ticks, at least 0.1 s. In lockstep min_interval is 1 ms by
/// default, and neither this process nor a guard has a watchdog.
/// @param width channels of the port
CommandSettings command_settings(const Parameters& keys, const CommandMapping& mapping,
                                 std::uint32_t width, const LoopClock& loop);

}  // namespace spikeloop::command
