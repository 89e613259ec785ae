#include "spikeloop/command/mapping.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "spikeloop/command/default_bounds.hpp"

namespace spikeloop::command {
namespace {

/// Fields that hold a position, and messages that are one.
constexpr std::array<std::string_view, 12> kPositions = {
    "position",   "positions",   "point",    "pose",      "orientation",    "quaternion",
    "transforms", "translation", "rotation", "transform", "steering_angle", "joint_angles"};
/// Fields that keep a robot moving if they are held.
constexpr std::array<std::string_view, 10> kRates = {
    "velocity", "velocities", "effort", "efforts", "accelerations",
    "linear",   "angular",    "speed",  "force",   "torque"};
constexpr std::array<std::string_view, 6> kPositionTypes = {
    "geometry_msgs/Point", "geometry_msgs/Point32",    "geometry_msgs/Pose2D",
    "geometry_msgs/Pose",  "geometry_msgs/Quaternion", "geometry_msgs/Transform"};

/// "elbow" of "position[name=elbow]"; empty if no name selects the element.
std::string selected_name(std::string_view component) {
  const auto equals = component.find('=');
  return equals == std::string_view::npos || !component.ends_with(']')
             ? ""
             : std::string(component.substr(equals + 1, component.size() - equals - 2));
}

/// The first component of a path, without the '.' after it. A name in brackets may contain '.'.
std::string_view first_component(std::string_view path) {
  std::size_t end = 0;
  for (bool inside = false; end < path.size() && (inside || path[end] != '.'); ++end) {
    inside = path[end] == '[' || (inside && path[end] != ']');
  }
  return path.substr(0, end);
}

/// Calls `take` with each component of a path, until it returns true.
template <typename Take>
bool any_component(std::string_view path, Take&& take) {
  while (!path.empty()) {
    const std::string_view component = first_component(path);
    path.remove_prefix(std::min(component.size() + 1, path.size()));
    if (take(component, component.substr(0, component.find('[')))) {
      return true;
    }
  }
  return false;
}

bool is_rate(std::string_view path) {
  return any_component(path, [](std::string_view, std::string_view name) {
    return std::ranges::find(kRates, name) != kRates.end();
  });
}

StopRule default_stop(const std::string& message_type, std::string_view path) {
  const bool is_position = std::ranges::find(kPositionTypes, message_type) != kPositionTypes.end();
  StopRule rule;
  any_component(path, [&](std::string_view component, std::string_view name) {
    if (!is_position && std::ranges::find(kPositions, name) == kPositions.end()) {
      return false;
    }
    rule = {.hold = true, .joint = selected_name(component)};
    return true;
  });
  return rule;
}

/// A field that is held without the name of a joint is held by that of its path. A velocity or an
/// effort is never held, because the robot would not stop.
StopRule stop_rule(const std::string& message_type, const CommandField& field) {
  const StopRule usual = default_stop(message_type, field.field);
  if (!field.stop) {
    return usual;
  }
  StopRule rule = *field.stop;
  if (rule.hold && is_rate(field.field)) {
    return {};
  }
  if (rule.hold && rule.joint.empty()) {
    rule.joint = usual.joint;
  }
  return rule;
}

}  // namespace

ComponentMap component_map(const CommandMapping& mapping, std::uint32_t width) {
  std::vector<Component> components;
  if (mapping.all_channels) {
    for (std::uint32_t channel = 0; channel < width; ++channel) {
      components.push_back({.channel = channel});
    }
  }
  for (const CommandField& field : mapping.fields) {
    Component component{.channel = field.channel, .scale = field.scale, .offset = field.offset};
    component.minimum = field.minimum.value_or(component.minimum);
    component.maximum = field.maximum.value_or(component.maximum);
    component.slew = field.slew.value_or(component.slew);
    components.push_back(component);
  }
  return ComponentMap(std::move(components));
}

std::vector<Bounds> default_bounds(const CommandMapping& mapping, std::vector<Bounds> bounds) {
  for (std::size_t i = 0; i < mapping.fields.size(); ++i) {
    const CommandField& field = mapping.fields[i];
    if (!field.minimum && !field.maximum) {
      const Bounds own = default_bounds(mapping.message_type, field.field);
      bounds[i].minimum = own.minimum;
      bounds[i].maximum = own.maximum;
    }
  }
  return bounds;
}

std::vector<StopRule> stop_rules(const CommandMapping& mapping, std::size_t width) {
  if (mapping.all_channels) {
    return std::vector<StopRule>(width, mapping.stop.value_or(StopRule{}));
  }
  std::vector<StopRule> rules;
  for (const CommandField& field : mapping.fields) {
    rules.push_back(stop_rule(mapping.message_type, field));
  }
  return rules;
}

std::vector<std::string> field_paths(const CommandMapping& mapping) {
  if (mapping.all_channels) {
    return {"data"};
  }
  std::vector<std::string> paths;
  paths.reserve(mapping.fields.size());
  for (const CommandField& field : mapping.fields) {
    paths.push_back(field.field);
  }
  return paths;
}

}  // namespace spikeloop::command
