// Message types as text: their definitions, sums, and the paths of their fields.
#pragma once

#include <string>

namespace spikeloop::app {

/// The names of all types that we bring, a line each, and of which ROS they are when not of both.
std::string message_list();

/// Whether a name is that of a message type, as users write it, rather than of anything else.
bool is_message_type(const std::string& name);

/// What a type is in each ROS that has it. @throws ConfigurationError: unknown, or a wrong file.
std::string message_text(const std::string& type);

}  // namespace spikeloop::app
