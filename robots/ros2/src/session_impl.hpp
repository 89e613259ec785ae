// What the parts of this module share of a session.
#pragma once

#include <atomic>
#include <string>

#include "acquaintance.hpp"
#include "dispatcher.hpp"
#include "graph.hpp"
#include "node_list.hpp"
#include "participant.hpp"
#include "raw_type.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/ros2/names.hpp"
#include "spikeloop/ros2/session.hpp"

namespace spikeloop::ros2 {

struct Session::Impl {
  explicit Impl(const topics::SessionSettings& settings);

  discovery::Variables place;
  discovery::Discovery found;
  NodeIdentity node;
  TopicNames names;
  Domain domain;
  Participant participant;
  Dispatcher dispatcher;
  Graph graph;
  RawTopic node_topic;
  NodeList nodes;
  Acquaintance acquaintance;
  std::atomic<bool> left{false};  ///< see Session::leave
};

/// A topic's names and type as DDS knows them, and what its endpoints say to ROS 2.
struct Endpoint {
  std::string topic;         ///< "/scan"
  std::string message_type;  ///< "sensor_msgs/LaserScan"
  std::string user_data;     ///< "typehash=RIHS01_...;"

  std::string dds_name() const { return dds_topic(topic); }
  std::string dds_type_name() const { return dds_type(message_type); }
};

/// @throws ConfigurationError for an unknown type or an impossible topic.
Endpoint endpoint(const Session::Impl& session, const std::string& topic,
                  const std::string& message_type);

}  // namespace spikeloop::ros2
