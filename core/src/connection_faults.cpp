#include "spikeloop/core/connection_faults.hpp"

#include <fmt/format.h>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop {

std::string unknown_node(std::string_view name, const std::vector<std::string>& known) {
  return with_code(Code::unknown_node, "unknown node '{}'{}", name, did_you_mean(name, known));
}

std::string unknown_port(std::string_view node, Direction direction, std::string_view port,
                         const std::vector<std::string>& known) {
  return with_code(Code::unknown_port, "'{}' has no {} port '{}'{}", node,
                   direction == Direction::input ? "input" : "output", port,
                   did_you_mean(port, known));
}

std::string kinds_differ(std::string_view from, PortKind from_kind, std::string_view to) {
  const bool spikes = from_kind == PortKind::spikes;
  return with_code(Code::kinds_differ,
                   "{} output '{}' cannot drive {} input '{}'; put {} between them",
                   spikes ? "spike" : "continuous", from, spikes ? "continuous" : "spike", to,
                   spikes ? "a decoder" : "an encoder");
}

std::string two_connections(std::string_view input, std::string_view first,
                            std::string_view second) {
  return first == second
             ? with_code(Code::two_senders,
                         "the connection '{} -> {}' is written twice; remove one", first, input)
             : with_code(Code::two_senders,
                         "input '{}' has two senders, '{}' and '{}'; remove one connection", input,
                         first, second);
}

std::string not_connected(std::string_view input) {
  return with_code(Code::not_connected,
                   "input '{0}' is not connected; write for example  SENDER.out -> {0} [10]",
                   input);
}

}  // namespace spikeloop
