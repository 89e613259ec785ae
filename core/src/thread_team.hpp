// A node whose channels are shared out to threads.
#pragma once

#include <memory>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// The node itself for one thread; else a node that steps one node a thread, and puts their outputs
/// together. What comes out does not depend on the number of threads.
/// @throws ConfigurationError when the class cannot share, or there are more parts than channels.
std::unique_ptr<Node> make_node(const NodeClass& node_class, const NodeSetup& setup,
                                unsigned threads);

}  // namespace spikeloop
