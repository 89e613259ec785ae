#include <fmt/format.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/check.hpp"

namespace spikeloop::launch {

void Findings::add_error(const Location& where, const std::string& message) {
  errors.push_back({ConfigurationError(where, message).what()});
}

void Findings::add_warning(const Location& where, const std::string& message, bool strict) {
  if (strict) {
    add_error(where, message);
  } else {
    warnings.emplace_back(ConfigurationError(where, message).what());
  }
}

void Findings::append(const Findings& others) {
  errors.insert(errors.end(), others.errors.begin(), others.errors.end());
  warnings.insert(warnings.end(), others.warnings.begin(), others.warnings.end());
}

Finding first_error(const Findings& findings, const std::string& file) {
  Finding first = findings.errors.front();
  if (const std::size_t more = findings.errors.size() - 1; more > 0) {
    first.text += fmt::format(" (and {} more: spikeloop check {})", more, file);
  }
  return first;
}

}  // namespace spikeloop::launch
