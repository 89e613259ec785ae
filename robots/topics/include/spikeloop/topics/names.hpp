// Names of topics and nodes in both versions of ROS, and the command-line tools of ROS.
#pragma once

#include <string>

#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::topics {

/// Version of ROS: 1 or 2.
int version_of(messages::Dialect ros);
/// Dialect of a version of ROS: 1 or 2.
messages::Dialect dialect_of(int version);
/// Name of a version of ROS: "ROS 1".
const char* name_of(messages::Dialect ros);
/// Command with the subcommands `list`, `info /scan` and `hz /scan`: "rostopic".
const char* topic_command(messages::Dialect ros);

/// @throws ConfigurationError if ROS does not accept the name of a topic.
void check_topic(messages::Dialect ros, const std::string& topic);
/// Converts a text to the name of a node. Characters that ROS does not accept become '_'.
std::string as_node_name(std::string text);
/// @throws ConfigurationError if ROS does not accept the name of a node.
void check_node_name(messages::Dialect ros, const std::string& name);

}  // namespace spikeloop::topics
