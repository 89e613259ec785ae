#include "spikeloop/core/diagnostic.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/reason.hpp"

namespace spikeloop {

std::string Diagnostic::text() const {
  return ConfigurationError(where, message).what();
}

Diagnostic error_at(const Location& where, std::string_view message) {
  return {where, one_line(message)};
}

Diagnostic warning_at(const Location& where, std::string_view message, bool strict) {
  return strict ? error_at(where, message) : Diagnostic{where, one_line(message), 0};
}

Diagnostic diagnostic_of(const Error& error) {
  return {error.where(), reason_of(error), error.exit_code()};
}

void append(Diagnostics& list, const Diagnostics& others) {
  list.insert(list.end(), others.begin(), others.end());
}

bool has_errors(const Diagnostics& list) {
  return std::ranges::any_of(list, &Diagnostic::is_error);
}

Diagnostic first_error(const Diagnostics& list, const std::string& file) {
  Diagnostic first = *std::ranges::find_if(list, &Diagnostic::is_error);
  if (const auto more = std::ranges::count_if(list, &Diagnostic::is_error) - 1; more > 0) {
    first.message = lengthened(first.message,
                               fmt::format(" (and {} more: spikeloop check {})", more, file));
  }
  return first;
}

}  // namespace spikeloop
