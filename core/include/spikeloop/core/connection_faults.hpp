// What can be wrong with a connection, in the words that experiments and .music files share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// "unknown node 'encodr'; did you mean 'encoder'?"
std::string unknown_node(std::string_view name, const std::vector<std::string>& known);
/// "'encoder' has no input port 'inn'; did you mean 'in'?"
std::string unknown_port(std::string_view node, Direction direction, std::string_view port,
                         const std::vector<std::string>& known);
/// Ends are "node.port"; `from_kind` is that of the sender, the receiver's is the other one.
std::string kinds_differ(std::string_view from, PortKind from_kind, std::string_view to);
/// Two connections to one input; the senders may be the same.
std::string two_connections(std::string_view input, std::string_view first,
                            std::string_view second);
/// "input 'decoder.in' is not connected; write for example  SENDER.out -> decoder.in [10]"
std::string not_connected(std::string_view input);

}  // namespace spikeloop
