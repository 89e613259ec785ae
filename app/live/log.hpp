// Lines on standard error, which the launcher prints.
#pragma once

#include <string_view>

namespace spikeloop::view {

/// Writes the line. If nobody reads standard error, the line is lost; the caller never waits.
void log_line(std::string_view text);

}  // namespace spikeloop::view
