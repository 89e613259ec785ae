#include "folder_json.hpp"

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop::app {

using nlohmann::json;

json read_folder_json(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 100'000'000;
  constexpr int kDeepest = 100;
  bool too_deep = false;
  // false: what is deeper is left out.
  const auto watch = [&](int depth, json::parse_event_t, json&) {
    too_deep = too_deep || depth > kDeepest;
    return depth <= kDeepest;
  };
  try {
    json result = json::parse(read_file(path, "run's file", kMostBytes), watch, false);
    return result.is_object() && !too_deep ? result : nullptr;
  } catch (const Error&) {
    return nullptr;
  }
}

}  // namespace spikeloop::app
