#include "spikeloop/core/number_or_word.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <utility>

namespace spikeloop {

ParameterDescription number_or_word_parameter(std::string name, std::string word,
                                              std::string text) {
  return {.name = std::move(name),
          .type = ParameterType::text,
          .default_value = std::move(word),
          .text = std::move(text)};
}

std::optional<double> number_or_word(const Parameters& given, const std::string& name,
                                     std::string_view word, std::string_view remedy) {
  const std::string& text = given.text(name);
  if (text.empty() || text == word) {
    return std::nullopt;
  }
  try {
    return parse_quantity(text, "");
  } catch (const ConfigurationError&) {
    throw ConfigurationError(
        given.where(name),
        with_code(Code::not_a_number, "key '{}': '{}' is neither a number nor '{}'; {}", name, text,
                  word, remedy));
  }
}

}  // namespace spikeloop
