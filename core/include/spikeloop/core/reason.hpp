// What an error says, without its place.
#pragma once

#include <algorithm>
#include <string>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

/// The message behind "FILE:LINE:COLUMN: ".
inline std::string reason_of(const Error& error) {
  const std::string text = error.what();
  const std::size_t place = error.located() ? error.where().text().size() + 2 : 0;
  return text.substr(std::min(place, text.size()));
}

}  // namespace spikeloop
