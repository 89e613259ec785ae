// Nodes that are simulators: a script of the user's in a process of its own, joined by MUSIC.
#pragma once

#include <span>
#include <string_view>

#include "spikeloop/core/node.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {

/// What `simulator:` can be, beside builtin.
struct Simulator {
  const char* name;
  const char* host;     ///< the module of ours that its script imports
  const char* module;   ///< the simulator's own; empty: none
  const char* install;  ///< how to get it
};
std::span<const Simulator> simulators();
/// Null for any other name.
const Simulator* find_simulator(std::string_view name);

/// The keys and ports of such a node, for the reference and the schema: a class of no name that
/// could be written behind `node:`.
const NodeDescription& simulator_description();
/// Names that a parameter of a script cannot have: keys of every MUSIC program, and of MUSIC.
std::span<const char* const> reserved_keys();

bool is_simulator(const Node& node);
/// Of the end of a connection, "brain.out".
bool is_simulator_end(const Experiment& experiment, const std::string& end);
bool has_simulator(const Experiment& experiment);

}  // namespace spikeloop::experiment
