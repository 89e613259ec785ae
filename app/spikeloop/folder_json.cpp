#include "folder_json.hpp"

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/parse_message.hpp"

namespace spikeloop::app {

using nlohmann::json;

json read_folder_json(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 100'000'000;
  constexpr int kDeepest = 100;
  try {
    json result = parse_message<json>(read_file(path, "run's file", kMostBytes), kDeepest);
    return result.is_object() ? result : nullptr;
  } catch (const Error&) {
    return nullptr;
  }
}

}  // namespace spikeloop::app
