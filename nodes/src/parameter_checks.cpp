#include "parameter_checks.hpp"

#include <fmt/format.h>

#include <utility>

namespace spikeloop {

namespace {

// Of two keys that contradict each other, one that the user wrote.
const Location& where_written(const Parameters& given, const char* low, const char* high) {
  return given.given(low) ? given.where(low) : given.where(high);
}

}  // namespace

ParameterDescription number_parameter(std::string name, std::string unit, std::string default_value,
                                      double minimum, double maximum, std::string text) {
  return {.name = std::move(name),
          .unit = std::move(unit),
          .default_value = std::move(default_value),
          .minimum = minimum,
          .maximum = maximum,
          .text = std::move(text)};
}

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
        fmt::format("key '{}': '{}' is neither a number nor '{}'; {}", name, text, word, remedy));
  }
}

void require_below(const Parameters& given, const char* low, const char* high) {
  if (given.number(low) >= given.number(high)) {
    throw ConfigurationError(
        where_written(given, low, high),
        fmt::format("key '{0}': {1} is not below {2}, {3}; write {0} below {2}", low,
                    given.number(low), high, given.number(high)));
  }
}

void require_at_most(const Parameters& given, const char* low, const char* high) {
  if (given.number(low) > given.number(high)) {
    throw ConfigurationError(where_written(given, low, high),
                             fmt::format("key '{0}': {1} is above {2}, {3}; write {0} at most {2}",
                                         low, given.number(low), high, given.number(high)));
  }
}

}  // namespace spikeloop
