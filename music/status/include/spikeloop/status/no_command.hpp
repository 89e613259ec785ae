// Finds out why a run that has ended sent no command to its robot.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace spikeloop::status {

struct NoCommand {
  bool nothing_usable = false;  ///< messages arrived, and none of them had a reading
  std::string reason;           ///< "no command was sent: ..."
};

/// Reason why a run with commands sent none, neither from the network nor manually; for a run with
/// sensors alone, why none of the messages that arrived was usable. nullopt otherwise.
/// @param counters of all nodes, by "NODE.COUNTER"; other values are ignored
std::optional<NoCommand> find_no_command(const nlohmann::json& counters);

}  // namespace spikeloop::status
