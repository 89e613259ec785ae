#include "spikeloop/command/mapping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>

namespace spikeloop::command {
namespace {

/// Names of fields that contain a position.
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

/// Name in brackets: "elbow" of "position[name=elbow]". Empty if no name selects the element.
std::string selected_name(std::string_view component) {
  const auto equals = component.find('=');
  return equals == std::string_view::npos || !component.ends_with(']')
             ? ""
             : std::string(component.substr(equals + 1, component.size() - equals - 2));
}

/// Splits a path at each '.'. A name in brackets may contain '.'.
std::vector<std::string_view> path_components(std::string_view path) {
  std::vector<std::string_view> components;
  bool in_brackets = false;
  for (std::size_t begin = 0, end = 0; end <= path.size(); ++end) {
    if (end == path.size() || (path[end] == '.' && !in_brackets)) {
      components.push_back(path.substr(begin, end - begin));
      begin = end + 1;
    } else {
      in_brackets = path[end] == '[' || (in_brackets && path[end] != ']');
    }
  }
  return components;
}

/// True if the name of a component, without its brackets, is in the list.
bool is_one_of(std::span<const std::string_view> names, std::string_view component) {
  return std::ranges::find(names, component.substr(0, component.find('['))) != names.end();
}

bool is_rate(std::string_view path) {
  return std::ranges::any_of(path_components(path), [](std::string_view component) {
    return is_one_of(kRates, component);
  });
}

StopRule default_stop(const std::string& message_type, std::string_view path) {
  const bool is_position = std::ranges::find(kPositionTypes, message_type) != kPositionTypes.end();
  for (const std::string_view component : path_components(path)) {
    if (is_position || is_one_of(kPositions, component)) {
      return {.hold = true, .joint = selected_name(component)};
    }
  }
  return {};
}

/// A held field without a joint in its rule uses the joint of its path. A velocity or an effort is
/// never held, because the robot would not stop.
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

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

class CommandMapNode : public Node {
 public:
  explicit CommandMapNode(const std::vector<CommandField>& components) {
    for (const CommandField& field : components) {
      components_.push_back({field.channel, field.scale, field.offset,
                             field.minimum.value_or(-kUnlimited),
                             field.maximum.value_or(kUnlimited)});
    }
  }

  void step(const Step& step) override {
    const SignalInput in = step.signal_input();
    if (in.revision == revision_) {
      return;
    }
    revision_ = in.revision;
    const SignalOutput out = step.signal_output();
    if (!in.valid()) {
      out.invalidate();
      return;
    }
    auto value = out.values().begin();
    for (const auto& [index, scale, offset, minimum, maximum] : components_) {
      const double channel = in.values[index];
      // An infinite channel must stop the robot; limits would hide it.
      *value++ =
          std::isfinite(channel) ? std::clamp(scale * channel + offset, minimum, maximum) : channel;
    }
    out.commit();
  }

 private:
  struct Component {
    std::uint32_t channel;
    double scale, offset, minimum, maximum;
  };
  std::vector<Component> components_;
  std::uint64_t revision_ = 0;
};

}  // namespace

std::vector<CommandField> components(const CommandMapping& mapping, std::uint32_t width) {
  std::vector<CommandField> components = mapping.fields;
  for (std::uint32_t i = 0; mapping.all_channels && i < width; ++i) {
    components.push_back({.field = fmt::format("data[{}]", i), .channel = i, .stop = mapping.stop});
  }
  return components;
}

std::vector<double> deadbands(const std::vector<CommandField>& components, double fraction) {
  std::vector<double> bands;
  for (const CommandField& component : components) {
    const bool limited = component.minimum && component.maximum;
    bands.push_back(fraction * (limited ? *component.maximum - *component.minimum
                                        : 2 * std::fabs(component.scale)));
  }
  return bands;
}

Bounds default_bounds(std::string_view message_type, std::string_view field) {
  constexpr double kSpeed = 1;         // m/s
  constexpr double kTurningSpeed = 3;  // rad/s
  const bool stamped = message_type == "geometry_msgs/TwistStamped";
  const std::string velocity = stamped ? "twist." : "";
  if (stamped || message_type == "geometry_msgs/Twist") {
    if (field.starts_with(velocity + "linear")) {
      return {.minimum = -kSpeed, .maximum = kSpeed};
    }
    if (field.starts_with(velocity + "angular")) {
      return {.minimum = -kTurningSpeed, .maximum = kTurningSpeed};
    }
  }
  return {};
}

std::vector<Bounds> bounds(const CommandMapping& mapping, std::uint32_t width, bool with_default) {
  std::vector<Bounds> result;
  for (const CommandField& field : components(mapping, width)) {
    const bool limited = field.minimum || field.maximum || !with_default;
    Bounds& own =
        result.emplace_back(limited ? Bounds{} : default_bounds(mapping.message_type, field.field));
    own.minimum = field.minimum.value_or(own.minimum);
    own.maximum = field.maximum.value_or(own.maximum);
    own.slew = field.slew.value_or(own.slew);
  }
  return result;
}

std::vector<StopRule> stop_rules(const CommandMapping& mapping, std::uint32_t width) {
  std::vector<StopRule> rules;
  for (const CommandField& field : components(mapping, width)) {
    rules.push_back(stop_rule(mapping.message_type, field));
  }
  return rules;
}

std::vector<std::string> field_paths(const CommandMapping& mapping) {
  if (mapping.all_channels) {
    return {"data"};
  }
  std::vector<std::string> paths(mapping.fields.size());
  std::ranges::transform(mapping.fields, paths.begin(), &CommandField::field);
  return paths;
}

NodeClass command_map_class(std::vector<CommandField> components) {
  NodeDescription description;
  description.name = "command_map";
  description.text = "Maps channels to the fields of a command";
  description.ports = {{"in", PortKind::signal, Direction::input, {}, "The channels"},
                       {"out", PortKind::signal, Direction::output, {}, "One value per field"}};
  return {description, [components = std::move(components)](const NodeSetup&) {
            return std::make_unique<CommandMapNode>(components);
          }};
}

}  // namespace spikeloop::command
