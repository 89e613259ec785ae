// A node class as a MUSIC program: every port of the class is a MUSIC port of the same name.
#pragma once

#include "spikeloop/core/node.hpp"
#include "spikeloop/process/process.hpp"

namespace spikeloop::music {

/// The key `threads`, for programs whose class can share.
std::vector<ParameterDescription> sharing_parameters();

/// Runs one node, named as the section, to the end. Inputs that the file leaves unconnected stay
/// silent (spikes) or invalid (signals), outputs go nowhere; at least one port must be connected.
/// np processes and `threads` in each share its output channels; all compute the same spikes.
/// @throws ConfigurationError for an unconnected input whose width no rule of the class gives, for
/// np or threads above 1 when the class cannot share.
int run_node(Process& process, const NodeClass& node_class, const Parameters& parameters,
             const Process::LoopHooks& hooks = {});

}  // namespace spikeloop::music
