#include "paired_channels.hpp"

#include <fmt/format.h>
#include "spikeloop/core/code.hpp"

namespace spikeloop {

std::vector<PortDescription> paired_channel_ports() {
  return {
      {"in", PortKind::signal, Direction::input, {}, "Values whose changes are encoded"},
      {"out",
       PortKind::spikes,
       Direction::output,
       {},
       "Two channels per value: channel 2d spikes when value d increases, 2d+1 when it decreases"}};
}

void require_paired_channels(const NodeSetup& setup) {
  const std::uint64_t wanted = std::uint64_t{2} * setup.widths[0];
  if (setup.widths[1] != wanted) {
    throw ConfigurationError(
        with_code(Code::widths_differ,
                  "port 'in' has {} channels and port 'out' {}; write [{}] in the connection of "
                  "'out': up and down of each value",
                  setup.widths[0], setup.widths[1], wanted));
  }
}

}  // namespace spikeloop
