// What everything says that deals with a plug-in's plain data.
#pragma once

#include <fmt/format.h>

#include <string>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop {

[[noreturn]] inline void refuse(const std::string& path, const std::string& reason) {
  throw ConfigurationError(with_code(Code::plug_in, "plug-in '{}': {}", path, reason));
}

inline std::string text_or_empty(const char* text) {
  return text == nullptr ? "" : text;
}

}  // namespace spikeloop
