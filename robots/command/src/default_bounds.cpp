#include "spikeloop/command/default_bounds.hpp"

namespace spikeloop::command {
namespace {

constexpr double kSpeed = 1;         // m/s
constexpr double kTurningSpeed = 3;  // rad/s

/// What stands before "linear.x" in messages that have a velocity.
std::string_view velocity_within(std::string_view message_type) {
  return message_type == "geometry_msgs/TwistStamped" ? "twist." : "";
}

}  // namespace

Bounds default_bounds(std::string_view message_type, std::string_view field) {
  if (message_type != "geometry_msgs/Twist" && message_type != "geometry_msgs/TwistStamped") {
    return {};
  }
  const std::string_view within = velocity_within(message_type);
  if (!field.starts_with(within)) {
    return {};
  }
  field.remove_prefix(within.size());
  if (field.starts_with("linear")) {
    return {.minimum = -kSpeed, .maximum = kSpeed};
  }
  if (field.starts_with("angular")) {
    return {.minimum = -kTurningSpeed, .maximum = kTurningSpeed};
  }
  return {};
}

}  // namespace spikeloop::command
