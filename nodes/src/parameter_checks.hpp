// Declarations and checks of parameters that several nodes share.
#pragma once

#include <string>

#include "spikeloop/core/number_or_word.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// A number with both bounds.
ParameterDescription number_parameter(std::string name, std::string unit, std::string default_value,
                                      double minimum, double maximum, std::string text);

/// The same, but it may change during a run.
ParameterDescription changeable(ParameterDescription parameter);

/// @throws ConfigurationError with both keys and values unless `low` < `high`.
void require_below(const Parameters& given, const char* low, const char* high);
/// @throws ConfigurationError with both keys and values unless `low` <= `high`.
void require_at_most(const Parameters& given, const char* low, const char* high);

}  // namespace spikeloop
