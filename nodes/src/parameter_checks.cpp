#include "parameter_checks.hpp"

#include <fmt/format.h>

#include <utility>
#include "spikeloop/core/code.hpp"

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

ParameterDescription changeable(ParameterDescription parameter) {
  parameter.changeable = true;
  return parameter;
}

void require_below(const Parameters& given, const char* low, const char* high) {
  if (given.number(low) >= given.number(high)) {
    throw ConfigurationError(
        where_written(given, low, high),
        with_code(Code::wrong_order, "key '{0}': {1} is not below {2}, {3}; write {0} below {2}",
                  low, given.number(low), high, given.number(high)));
  }
}

void require_at_most(const Parameters& given, const char* low, const char* high) {
  if (given.number(low) > given.number(high)) {
    throw ConfigurationError(
        where_written(given, low, high),
        with_code(Code::wrong_order, "key '{0}': {1} is above {2}, {3}; write {0} at most {2}", low,
                  given.number(low), high, given.number(high)));
  }
}

}  // namespace spikeloop
