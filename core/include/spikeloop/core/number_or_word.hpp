// Parameters that are a number or one word: "none", "auto".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// The word is the default.
ParameterDescription number_or_word_parameter(std::string name, std::string word, std::string text);
/// Its number; nothing for the word. `remedy` ends the message: "write a number above 0, or auto".
/// @throws ConfigurationError when it is neither.
std::optional<double> number_or_word(const Parameters& given, const std::string& name,
                                     std::string_view word, std::string_view remedy);

}  // namespace spikeloop
