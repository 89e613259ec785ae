// The texts of robots/messages/msg, compiled in.
#pragma once

#include <string_view>
#include <vector>

#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::messages {

struct EmbeddedDefinition {
  std::string_view name;  ///< "sensor_msgs/LaserScan"
  std::string_view text;
};

const std::vector<EmbeddedDefinition>& embedded_definitions(Dialect dialect);

}  // namespace spikeloop::messages
