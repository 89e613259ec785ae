#include "spikeloop/ros2/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::ros2 {
namespace {

constexpr std::size_t kLongestTopic = 248;  // of 256 in DDS, ROS 2 keeps 8 for prefixes
constexpr std::string_view kTopicPrefix = "rt";
constexpr std::string_view kTypeMiddle = "::msg::dds_::";

std::string below(const std::string& space, const std::string& name) {
  return space == "/" ? "/" + name : space + "/" + name;
}

std::string checked_space(const std::string& written) {
  std::string space = written.starts_with('/') ? written : "/" + written;
  try {
    if (space != "/") {
      topics::check_topic(messages::Dialect::ros2, space);
    }
  } catch (const ConfigurationError&) {
    throw ConfigurationError(
        with_code(Code::invalid_name,
                  "'{}' is not a namespace of ROS 2; write letters, digits, '_' and '/', as in "
                  "__ns:=/arena/left",
                  written));
  }
  return space;
}

/// A rule for one node alone says so before a colon.
bool is_for(const NodeIdentity& node, std::string& name) {
  const auto colon = name.find(':');
  if (colon == std::string::npos) {
    return true;
  }
  const bool ours = name.substr(0, colon) == node.name;
  name.erase(0, colon + 1);
  return ours;
}

}  // namespace

std::string NodeIdentity::whole() const {
  return below(space, name);
}

NodeIdentity node_identity(const std::string& name, const topics::RosArguments& arguments) {
  NodeIdentity node{.name = name};
  if (const auto found = arguments.find("__name"); found != arguments.end()) {
    node.name = found->second;
  }
  topics::check_node_name(messages::Dialect::ros2, node.name);
  if (const auto found = arguments.find("__ns"); found != arguments.end()) {
    node.space = checked_space(found->second);
  }
  return node;
}

TopicNames::TopicNames(const NodeIdentity& node, const topics::RosArguments& arguments)
    : node_(node) {
  for (const auto& [from, to] : arguments) {
    std::string name = from;
    if (!name.starts_with("__") && is_for(node_, name)) {
      remapped_.emplace_back(expanded(name), expanded(to));
    }
  }
}

std::string TopicNames::expanded(const std::string& topic) const {
  topics::check_topic(messages::Dialect::ros2, topic);
  if (topic.starts_with('/')) {
    return topic;
  }
  return topic.starts_with('~') ? below(node_.whole(), topic.substr(2)) : below(node_.space, topic);
}

std::string TopicNames::whole(const std::string& topic) const {
  const std::string name = expanded(topic);
  const auto rule = std::find_if(remapped_.begin(), remapped_.end(),
                                 [&](const auto& entry) { return entry.first == name; });
  return rule == remapped_.end() ? name : rule->second;
}

std::string dds_topic(const std::string& whole_topic) {
  if (whole_topic.size() > kLongestTopic) {
    throw ConfigurationError(with_code(
        Code::invalid_topic,
        "the topic '{}' has {} characters; ROS 2 takes {} at most, so write a shorter name",
        whole_topic, whole_topic.size(), kLongestTopic));
  }
  return std::string(kTopicPrefix) + whole_topic;
}

std::string dds_type(const std::string& message_type) {
  const auto slash = message_type.find('/');
  return fmt::format("{}{}{}_", message_type.substr(0, slash), kTypeMiddle,
                     message_type.substr(slash + 1));
}

std::string ros_type(const std::string& dds_type) {
  const auto middle = dds_type.find(kTypeMiddle);
  if (middle == std::string::npos || !dds_type.ends_with('_')) {
    return dds_type;
  }
  const auto name = middle + kTypeMiddle.size();
  return fmt::format("{}/{}", dds_type.substr(0, middle),
                     dds_type.substr(name, dds_type.size() - name - 1));
}

}  // namespace spikeloop::ros2
