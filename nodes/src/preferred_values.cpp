#include "preferred_values.hpp"

#include <fmt/format.h>

#include "parameter_checks.hpp"
#include "spikeloop/core/code.hpp"

namespace spikeloop {

void append_value_range(std::vector<ParameterDescription>& parameters) {
  constexpr double kMost = 1e9;
  parameters.push_back(
      number_parameter("value_min", "1", "-1", -kMost, kMost, "Smallest preferred value"));
  parameters.push_back(
      number_parameter("value_max", "1", "1", -kMost, kMost, "Largest preferred value"));
  parameters.push_back(
      {.name = "circular",
       .type = ParameterType::boolean,
       .default_value = "false",
       .text = "The range is circular, as for angles: value_max is equivalent to value_min"});
}

ValueRange value_range(const Parameters& given) {
  require_below(given, "value_min", "value_max");
  return {given.number("value_min"), given.number("value_max"), given.boolean("circular")};
}

double spacing(const ValueRange& range, std::uint32_t neurons) {
  const std::uint32_t gaps = range.circular ? neurons : neurons - 1;
  return gaps == 0 ? range.length() : range.length() / gaps;
}

std::vector<double> preferred_values(const ValueRange& range, std::uint32_t neurons) {
  if (neurons == 1 && !range.circular) {
    return {range.minimum + range.length() / 2};
  }
  std::vector<double> values(neurons);
  const double gaps = range.circular ? neurons : neurons - 1;
  for (std::uint32_t i = 0; i < neurons; ++i) {
    values[i] = range.minimum + i / gaps * range.length();
  }
  return values;
}

std::uint32_t neurons_a_value(const NodeSetup& setup, std::size_t neurons, std::size_t values) {
  const std::uint32_t all = setup.widths[neurons];
  const std::uint32_t wanted = setup.widths[values];
  if (all % wanted != 0) {
    const char* port = neurons == 0 ? "in" : "out";
    throw ConfigurationError(with_code(
        Code::widths_differ,
        "port '{0}' has {1} channels and port '{2}' {3}; make '{0}' a multiple of {3} wide: as "
        "many neurons for each value",
        port, all, values == 0 ? "in" : "out", wanted));
  }
  return all / wanted;
}

}  // namespace spikeloop
