// Sessions of ROS 1 with a test's own master.
#pragma once

#include <cstdlib>
#include <string>

#include "spikeloop/ros1/session.hpp"

namespace spikeloop::test {

inline ros1::SessionSettings node_at(const std::string& master_uri, const std::string& name) {
  ::setenv("ROS_HOSTNAME", "localhost", 0);  // a machine need not know its own name
  ros1::SessionSettings settings;
  settings.node_name = name;
  settings.unique_name = true;
  settings.place = {{"ROS_MASTER_URI", master_uri}};
  return settings;
}

}  // namespace spikeloop::test
