#include "spikeloop/config/parameter_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace spikeloop {

namespace {

using Row = std::array<std::string, 5>;

constexpr const char* kChangeable = "; can be changed during a run";

std::string type_text(const ParameterDescription& parameter) {
  switch (parameter.type) {
    case ParameterType::number:
      return parameter.unit.empty() || parameter.unit == "1" ? "number" : parameter.unit;
    case ParameterType::integer:
      return "integer";
    case ParameterType::boolean:
      return "true|false";
    case ParameterType::text:
      return "text";
    case ParameterType::choice:
      return "choice";
    case ParameterType::weights:
      return "weights";
    case ParameterType::list:
      return "list";
    case ParameterType::map:
      return "map";
  }
  return {};
}

std::string bounds_text(const ParameterDescription& parameter) {
  if (parameter.type == ParameterType::choice) {
    return fmt::format("{}", fmt::join(parameter.choices, "|"));
  }
  const bool low = std::isfinite(parameter.minimum);
  const bool high = std::isfinite(parameter.maximum);
  if (low && high) {
    return fmt::format("{} .. {}", parameter.minimum, parameter.maximum);
  }
  return low    ? fmt::format(">= {}", parameter.minimum)
         : high ? fmt::format("<= {}", parameter.maximum)
                : std::string();
}

std::string default_text(const ParameterDescription& parameter) {
  if (!parameter.default_value) {
    return "required";
  }
  if (parameter.default_value->empty()) {
    return parameter.type == ParameterType::text ? "\"\"" : "none";
  }
  return *parameter.default_value;
}

/// The keys of a map, or of those that a list or a map holds.
std::vector<ParameterDescription> inner_keys(const ParameterDescription& parameter) {
  if (parameter.inner.empty()) {
    return {};
  }
  const ParameterDescription& first = parameter.inner.front();
  const bool own_keys = parameter.type == ParameterType::map && first.name != kAnyKey;
  return own_keys ? parameter.inner : inner_keys(first);
}

std::string table(const std::vector<ParameterDescription>& parameters) {
  std::vector<Row> rows;
  std::array<std::size_t, 5> widths{};
  for (const auto& parameter : parameters) {
    rows.push_back({parameter.name, type_text(parameter), default_text(parameter),
                    bounds_text(parameter),
                    parameter.text + (parameter.changeable ? kChangeable : "")});
    for (std::size_t i = 0; i < widths.size(); ++i) {
      widths[i] = std::max(widths[i], rows.back()[i].size());
    }
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += widths[i] == 0 ? "" : fmt::format("  {:<{}}", row[i], widths[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

}  // namespace

std::string parameter_text(const std::vector<ParameterDescription>& parameters) {
  std::string text = table(parameters);
  for (const ParameterDescription& parameter : parameters) {
    if (const auto& keys = inner_keys(parameter); !keys.empty()) {
      text += fmt::format("\n  {}: {}\n{}", parameter.name, parameter.example, table(keys));
    }
  }
  return text;
}

}  // namespace spikeloop
