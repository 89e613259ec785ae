// The JSON Schema of experiment files, with which editors complete and check them.
#pragma once

#include <string>

#include "spikeloop/experiment/node_types.hpp"

namespace spikeloop::experiment {

/// Draft 07, as YAML's language server reads it: every key of every kind of node with its type,
/// units, bounds, choices, default and description. What needs other files or the rest of the
/// experiment (widths, topics, cycles) is left to resolve(). Ends with a line end.
std::string json_schema(const NodeTypes& types);

}  // namespace spikeloop::experiment
