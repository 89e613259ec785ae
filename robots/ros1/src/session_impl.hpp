// What the parts of this room share of roscpp.
#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "spikeloop/ros1/session.hpp"

namespace spikeloop::ros1 {

struct Session::Impl {
  ros::CallbackQueue queue;
  std::unique_ptr<ros::NodeHandle> node;
  std::atomic<bool> ending{false};
  std::thread thread;
};

}  // namespace spikeloop::ros1
