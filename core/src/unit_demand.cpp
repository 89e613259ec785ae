#include "spikeloop/core/unit_demand.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace spikeloop {
namespace {

bool has_unit(const ParameterDescription& parameter) {
  return parameter.type == ParameterType::number && !parameter.unit.empty() &&
         parameter.unit != "1";
}

/// "tau: 30 ms". Of seconds and milliseconds the one that is nearer to the default; both where it
/// says nothing.
std::string example_of(const ParameterDescription& parameter, const std::string& text) {
  const std::string in_unit = fmt::format("{}: {} {}", parameter.name, text, parameter.unit);
  if (parameter.unit != "s") {
    return in_unit;
  }
  const std::string in_ms = fmt::format("{}: {} ms", parameter.name, text);
  const std::string written = parameter.default_value.value_or("");
  const double usual = written.empty() ? 0 : parse_quantity(written, parameter.unit);
  if (usual == 0) {
    return in_ms + "  or  " + in_unit;
  }
  const double factor = std::abs(std::strtod(text.c_str(), nullptr) / usual);
  return factor > std::sqrt(1000.0) ? in_ms : in_unit;
}

}  // namespace

bool lacks_unit(const ParameterDescription& parameter, const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const bool bare = !text.empty() && *end == '\0';
  return bare && number != 0 && has_unit(parameter);
}

void demand_unit(const std::string& what, const ParameterDescription& parameter,
                 const WrittenValue& written) {
  const std::string& text = written.text;
  if (lacks_unit(parameter, text)) {
    throw ConfigurationError(
        written.where,
        with_code(Code::wrong_unit, "{}key '{}': {} has no unit; write for example  {}",
                  what.empty() ? "" : what + ": ", parameter.name, text,
                  example_of(parameter, text)));
  }
}

}  // namespace spikeloop
