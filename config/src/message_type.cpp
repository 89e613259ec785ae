#include "spikeloop/config/message_type.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "music_text.hpp"
#include "spikeloop/config/data_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop {

namespace {

struct MessageName {
  std::string_view package;
  std::string_view name;
  std::string_view older;  ///< what the older programs call it
};

constexpr MessageName kNames[] = {{"sensor_msgs", "LaserScan", "Laserscan"},
                                  {"geometry_msgs", "Twist", "Twist"},
                                  {"std_msgs", "Float64MultiArray", "FloatArray"},
                                  {"nav_msgs", "Odometry", "Odom"}};

std::string definition_file(const std::string& written, const std::filesystem::path& base) {
  const auto file = find_data_file(written, base);
  if (!file) {
    throw ConfigurationError(with_code(Code::unknown_message,
                                       "there is no message definition '{}' in {}; write its path",
                                       music_text::shown(written), data_file_places(base)));
  }
  return std::filesystem::absolute(*file).lexically_normal().string();
}

}  // namespace

std::string canonical_message_type(std::string_view text, const std::filesystem::path& base) {
  std::vector<std::string> candidates;
  for (const auto& name : kNames) {
    if (text == name.name || text == name.older) {
      return fmt::format("{}/{}", name.package, name.name);
    }
    candidates.emplace_back(name.name);
  }
  if (is_definition_file(text)) {
    return definition_file(std::string(text), base);
  }
  constexpr std::string_view kFolder = "/msg/";
  std::string type(text);
  if (const auto folder = type.find(kFolder); folder != std::string::npos) {
    type.replace(folder, kFolder.size(), "/");
  }
  if (std::ranges::count(type, '/') == 1 && !type.starts_with('/') && !type.ends_with('/')) {
    return type;
  }
  const std::string meant = nearest(text, candidates);
  throw ConfigurationError(
      with_code(Code::unknown_message, "unknown message type '{}'; {}", music_text::shown(text),
                meant.empty() ? "write package/Type, or the path of a .msg file"
                              : fmt::format("did you mean '{}'?", meant)));
}

bool is_definition_file(std::string_view type) {
  return type.ends_with(".msg");
}

}  // namespace spikeloop
