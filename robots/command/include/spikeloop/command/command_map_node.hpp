// The mapping from channels to the fields of a command, as a node: what it puts out can be
// recorded.
#pragma once

#include "spikeloop/command/component_map.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop::command {

/// Ports: `in`, the channels; `out`, a value a field of the command.
NodeClass command_map_class(ComponentMap map);

}  // namespace spikeloop::command
