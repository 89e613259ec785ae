#include "spike_moments.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "parameter_checks.hpp"

namespace spikeloop {

void SpikeMoments::check_channels(std::span<const Spike> spikes, std::uint32_t width) {
  for (const Spike& spike : spikes) {
    if (static_cast<std::uint32_t>(spike.channel) >= width) {
      throw std::runtime_error(
          fmt::format("a spike came on channel {}, but port 'in' has channels 0 "
                      "to {}; make the connection wider or mend the sender",
                      spike.channel, width - 1));
    }
  }
}

ParameterDescription kernel_tau_parameter() {
  return number_parameter("tau", "s", "0.03", 1e-6, 1e6, "Time constant of the exponential kernel");
}

}  // namespace spikeloop
