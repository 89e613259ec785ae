// The texts of robots/messages/msg, compiled in.
#pragma once

#include <string_view>
#include <vector>

namespace spikeloop::messages {

struct EmbeddedDefinition {
  std::string_view name;  ///< "sensor_msgs/LaserScan"
  std::string_view text;
};

const std::vector<EmbeddedDefinition>& embedded_definitions();

}  // namespace spikeloop::messages
