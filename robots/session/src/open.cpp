#include "spikeloop/session/open.hpp"

#include "spikeloop/ros1/master.hpp"
#include "spikeloop/ros1/session.hpp"
#include "spikeloop/ros2/session.hpp"

namespace spikeloop::session {

std::unique_ptr<topics::Session> open(const Settings& settings) {
  if (settings.ros == messages::Dialect::ros2) {
    return std::make_unique<ros2::Session>(settings);
  }
  ros1::SessionSettings ros1{settings, settings.master_timeout};
  if (settings.cancelled != nullptr &&
      !ros1::require_master(ros1::master_of(ros1), settings.master_timeout, settings.cancelled)) {
    return nullptr;
  }
  return std::make_unique<ros1::Session>(ros1);
}

}  // namespace spikeloop::session
