// Names of topics and nodes, as both versions of ROS want them, and what their users call ROS's
// tools.
#pragma once

#include <string>

#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::topics {

/// 1 or 2.
int version_of(messages::Dialect ros);
/// Of 1 or 2.
messages::Dialect dialect_of(int version);
/// "ROS 1"
const char* name_of(messages::Dialect ros);
/// "rostopic": the command that knows `list`, `info /scan` and `hz /scan`.
const char* topic_command(messages::Dialect ros);

/// @throws ConfigurationError when ROS would refuse the name of a topic.
void check_topic(messages::Dialect ros, const std::string& topic);
/// A node's name of any text: what ROS does not accept is '_'.
std::string as_node_name(std::string text);
/// @throws ConfigurationError when ROS would refuse the name of a node.
void check_node_name(messages::Dialect ros, const std::string& name);

}  // namespace spikeloop::topics
