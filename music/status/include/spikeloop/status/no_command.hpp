// Whether a run that ended by itself has driven its robot, and why not.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace spikeloop::status {

/// Exit code of a run that received messages and could use none of them.
inline constexpr int kNothingUsable = 7;

struct NoCommand {
  bool nothing_usable = false;  ///< messages arrived, and none of them had a reading
  std::string reason;           ///< "no command was sent: ..."
};

/// Of a run with commands: a result if none of them was ever sent, by the network or manually. Of a
/// run with sensors alone: a result if messages arrived and none was usable.
/// @param counters of all nodes, by "NODE.COUNTER"; other values are ignored
std::optional<NoCommand> find_no_command(const nlohmann::json& counters);

}  // namespace spikeloop::status
