#include "spikeloop/config/message_type.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "music_text.hpp"
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

}  // namespace

std::vector<std::string> known_message_types() {
  std::vector<std::string> types;
  for (const auto& name : kNames) {
    types.push_back(fmt::format("{}/{}", name.package, name.name));
  }
  return types;
}

std::string canonical_message_type(std::string_view text) {
  std::vector<std::string> candidates;
  for (const auto& name : kNames) {
    std::string type = fmt::format("{}/{}", name.package, name.name);
    if (text == name.name || text == name.older || text == type ||
        text == fmt::format("{}/msg/{}", name.package, name.name)) {
      return type;
    }
    candidates.push_back(type);
    candidates.emplace_back(name.name);
  }
  // A name without its package is compared with names, a full one with full names.
  const bool full = text.find('/') != std::string_view::npos;
  std::erase_if(candidates, [&](const std::string& candidate) {
    return full != (candidate.find('/') != std::string::npos);
  });
  throw ConfigurationError(fmt::format("unknown message type '{}'{}", music_text::shown(text),
                                       did_you_mean(text, candidates)));
}

}  // namespace spikeloop
