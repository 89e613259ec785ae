// What experiment files take, as text: all of it comes from the declarations.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/experiment/node_types.hpp"

namespace spikeloop::app {

/// Nodes that only experiment files have: topics, recordings, the network. Sorted.
std::vector<std::string> experiment_classes(const experiment::NodeTypes& types);

/// A line each.
std::string experiment_class_list(const experiment::NodeTypes& types);

/// Ports, parameters and how to write it.
std::string experiment_class_text(const NodeDescription& description);

/// The file's keys, those of `robot` and of connections, and the nodes above. As Markdown it is a
/// part of docs/experiment-file.md.
std::string experiment_reference(const experiment::NodeTypes& types, bool markdown);

}  // namespace spikeloop::app
