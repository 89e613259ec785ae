// Which publishers know of our subscribers.
#pragma once

#include <dds/dds.h>

#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "graph.hpp"
#include "raw_type.hpp"

namespace spikeloop::ros2 {

/// Topics and types as DDS has them.
class Acquaintance {
 public:
  /// @param any a topic of the participant's, whichever
  Acquaintance(dds_entity_t participant, const RawTopic& any, const Graph& graph);

  void subscribe(const std::string& topic, const std::string& type);
  void unsubscribe(const std::string& topic, const std::string& type);
  /// Whether a topic has publishers, of a type that we subscribe to, and all of them know us.
  bool with_publishers(const std::string& topic);

 private:
  bool announced_to_all(const std::string& topic, const std::multiset<std::string>& types) const;

  dds_guid_t own_{};
  const RawTopic& any_;
  const Graph& graph_;
  std::mutex mutex_;
  std::map<std::string, std::multiset<std::string>> subscribed_{};            ///< types by topic
  std::map<std::string, std::chrono::steady_clock::time_point> announced_{};  ///< since when
};

}  // namespace spikeloop::ros2
