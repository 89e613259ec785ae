#include "spikeloop/core/unit_demand.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace spikeloop {
namespace {

bool has_unit(const ParameterDescription& parameter) {
  return parameter.type == ParameterType::number && !parameter.unit.empty() &&
         parameter.unit != "1";
}

}  // namespace

void demand_unit(const std::string& what, const ParameterDescription& parameter,
                 const WrittenValue& written) {
  const std::string& text = written.text;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const bool bare = !text.empty() && *end == '\0';
  if (bare && number != 0 && has_unit(parameter)) {
    throw ConfigurationError(
        written.where,
        with_code(Code::wrong_unit,
                  "{0}key '{1}': {2} has no unit; write for example  {1}: {2} {3}",
                  what.empty() ? "" : what + ": ", parameter.name, text, parameter.unit));
  }
}

}  // namespace spikeloop
