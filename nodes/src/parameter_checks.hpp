// Declarations and checks of parameters that several nodes share.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// A number with both bounds.
ParameterDescription number_parameter(std::string name, std::string unit, std::string default_value,
                                      double minimum, double maximum, std::string text);

/// A parameter that is a number or one word, which is its default: "none", "auto".
ParameterDescription number_or_word_parameter(std::string name, std::string word, std::string text);
/// Its number; nothing for the word. `remedy` ends the message: "write a number above 0, or auto".
/// @throws ConfigurationError when it is neither.
std::optional<double> number_or_word(const Parameters& given, const std::string& name,
                                     std::string_view word, std::string_view remedy);

/// @throws ConfigurationError with both keys and values unless `low` < `high`.
void require_below(const Parameters& given, const char* low, const char* high);
/// @throws ConfigurationError with both keys and values unless `low` <= `high`.
void require_at_most(const Parameters& given, const char* low, const char* high);

}  // namespace spikeloop
