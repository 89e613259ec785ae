#include "paired_channels.hpp"

#include <fmt/format.h>
#include "spikeloop/core/code.hpp"

namespace spikeloop {

std::vector<PortDescription> paired_channel_ports() {
  return {{"in", PortKind::signal, Direction::input, {}, "The values whose changes are encoded"},
          {"out",
           PortKind::spikes,
           Direction::output,
           {},
           "Two channels a value: 2d spikes when value d goes up, 2d+1 when it goes down"}};
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
