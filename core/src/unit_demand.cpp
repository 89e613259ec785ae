#include "spikeloop/core/unit_demand.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace spikeloop {
namespace {

bool has_unit(const ParameterDescription& parameter) {
  return parameter.type == ParameterType::number && !parameter.unit.empty() &&
         parameter.unit != "1";
}

}  // namespace

std::string missing_unit(const ParameterDescription& parameter, const WrittenValue& written) {
  const std::string& text = written.text;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const bool bare = !text.empty() && *end == '\0';
  return bare && number != 0 && has_unit(parameter)
             ? fmt::format("{1} has no unit; write for example  {0}: {1} {2}", parameter.name, text,
                           parameter.unit)
             : "";
}

void demand_unit(const std::string& what, const ParameterDescription& parameter,
                 const WrittenValue& written) {
  if (const std::string missing = missing_unit(parameter, written); !missing.empty()) {
    throw ConfigurationError(written.where,
                             fmt::format("{}: key '{}': {}", what, parameter.name, missing));
  }
}

}  // namespace spikeloop
