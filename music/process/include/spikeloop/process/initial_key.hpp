// The key `initial` of programs that bring a signal in from outside.
#pragma once

#include <optional>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop::music {

ParameterDescription initial_parameter();
/// Its value; nothing for `none`. @throws ConfigurationError when it is neither.
std::optional<double> initial_value(const Parameters& parameters);

}  // namespace spikeloop::music
