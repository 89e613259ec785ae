#include "spike_moments.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "parameter_checks.hpp"

namespace spikeloop {

void refuse_channel(std::int32_t channel, std::uint32_t width) {
  throw std::runtime_error(
      fmt::format("a spike came on channel {}, but port 'in' has channels 0 "
                  "to {}; make the connection wider or mend the sender",
                  channel, width - 1));
}

ParameterDescription kernel_tau_parameter() {
  return number_parameter("tau", "s", "0.03", 1e-6, 1e6, "Time constant of the exponential kernel");
}

}  // namespace spikeloop
