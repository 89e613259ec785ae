// A node that begins anew by being made again.
#pragma once

#include <memory>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// A node of a class with Reset::made_again whose Node::reset() works. From then on it sees what a
/// node of a run that has just begun sees: time from 0, outputs without a value. For those who read
/// the outputs, time and revisions go on. Parameters that were changed stay changed, and counters
/// count on. Of other classes the node itself. @throws ConfigurationError as make_node().
std::unique_ptr<Node> make_renewable_node(const NodeClass& node_class, const NodeSetup& setup,
                                          unsigned threads);

}  // namespace spikeloop
