// Where in a text file a byte stands.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

/// Line and column (in characters) of a byte; "\n", "\r\n" and a lone "\r" end a line.
Location locate(std::string_view text, std::size_t offset, const std::string& file);

}  // namespace spikeloop
