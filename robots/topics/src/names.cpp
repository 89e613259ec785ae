#include "spikeloop/topics/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {
namespace {

using messages::Dialect;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_word(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return is_letter(c) || is_digit(c) || c == '_'; });
}

/// ROS 1 checks the first letter of the whole name, and each letter by itself.
bool is_ros1_topic(std::string_view topic) {
  return !topic.empty() && (is_letter(topic.front()) || topic.front() == '/') &&
         std::ranges::all_of(topic, [](char c) {
           return c == '/' || is_word({&c, 1});
         });
}

/// ROS 2 checks each part between slashes. A leading "~/" is the private namespace of the node.
bool is_ros2_topic(std::string_view topic) {
  if (topic.starts_with('~')) {
    topic.remove_prefix(1);
    if (!topic.starts_with('/')) {
      return false;
    }
  }
  if (topic.starts_with('/')) {
    topic.remove_prefix(1);
  }
  while (true) {
    const auto end = topic.find('/');
    const std::string_view part = topic.substr(0, end);
    if (part.empty() || is_digit(part.front()) || !is_word(part)) {
      return false;
    }
    if (end == topic.npos) {
      return true;
    }
    topic.remove_prefix(end + 1);
  }
}

bool is_node_name(Dialect ros, std::string_view name) {
  if (name.empty() || !is_word(name)) {
    return false;
  }
  return ros == Dialect::ros1 ? is_letter(name.front()) : !is_digit(name.front());
}

/// geometry_msgs/TwistStamped has a header and the member `twist`.
constexpr const char* kStamped = "Stamped";

/// Member of the stamped type: "twist" of "geometry_msgs/Twist".
std::string member_of(const std::string& type) {
  std::string name = type.substr(type.rfind('/') + 1);
  std::ranges::transform(name, name.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  while (!name.empty() && is_digit(name.back())) {
    name.pop_back();  // `vector` of Vector3Stamped
  }
  return name;
}

}  // namespace

int version_of(Dialect ros) {
  return ros == Dialect::ros1 ? 1 : 2;
}

Dialect dialect_of(int version) {
  return version == 2 ? Dialect::ros2 : Dialect::ros1;
}

const char* name_of(Dialect ros) {
  return ros == Dialect::ros1 ? "ROS 1" : "ROS 2";
}

const char* topic_command(Dialect ros) {
  return ros == Dialect::ros1 ? "rostopic" : "ros2 topic";
}

void check_topic(Dialect ros, const std::string& topic) {
  if (ros == Dialect::ros1 && !is_ros1_topic(topic)) {
    throw ConfigurationError(with_code(
        Code::invalid_topic,
        "'{}' is not a valid ROS topic name; write letters, digits, '_' and '/', beginning with a "
        "letter or '/', as in /cmd_vel",
        topic));
  }
  if (ros == Dialect::ros2 && !is_ros2_topic(topic)) {
    throw ConfigurationError(
        with_code(Code::invalid_topic,
                  "'{}' is not a valid ROS 2 topic name; write letters, digits, '_' and '/', no "
                  "part beginning "
                  "with a digit, as in /cmd_vel or ~/cmd_vel",
                  topic));
  }
}

std::string as_node_name(std::string text) {
  std::ranges::replace_if(
      text,
      [](char c) {
        return !is_word({&c, 1});
      },
      '_');
  return text;
}

void check_node_name(Dialect ros, const std::string& name) {
  if (!is_node_name(ros, name)) {
    throw ConfigurationError(with_code(
        Code::invalid_topic,
        "'{}' is not a valid ROS node name; write a letter followed by letters, digits and '_'",
        name));
  }
}

OtherType other_type(const std::string& topic, const std::string& type, const std::string& wanted,
                     std::function<std::string()> node) {
  return {type, fmt::format("topic '{}' carries {}, not {}", topic, type, wanted), std::move(node)};
}

std::string remedy_for_type(const std::string& type, const std::string& wanted) {
  std::string text = fmt::format("write  message: {0}  (in a .music file  message_type={0})", type);
  if (type == wanted + kStamped) {
    text += fmt::format(", and its fields as {}.FIELD", member_of(wanted));
  } else if (wanted == type + kStamped) {
    text += fmt::format(", and its fields without '{}.'", member_of(type));
  }
  return text;
}

}  // namespace spikeloop::topics
