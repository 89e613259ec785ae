#include "spikeloop/core/plugin_path.hpp"

#include <cstdlib>

namespace spikeloop {

std::string_view plugin_path() {
  const char* const written = std::getenv("SPIKELOOP_PLUGIN_PATH");
  return written == nullptr ? "" : written;
}

std::vector<std::string> path_list(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const auto colon = text.find(':');
    if (colon != 0) {
      parts.emplace_back(text.substr(0, colon));
    }
    text = colon == std::string_view::npos ? "" : text.substr(colon + 1);
  }
  return parts;
}

}  // namespace spikeloop
