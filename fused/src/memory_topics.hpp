// Topics within a process: the same bytes as over ROS, without ROS.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/fused/transport.hpp"

namespace spikeloop::fused {

class MemoryTopics {
 public:
  using Take = std::function<void(std::span<const std::byte>, TimeNs now)>;

  void subscribe(const std::string& topic, Take take) { takers_[topic].push_back(std::move(take)); }
  bool has(const std::string& topic) const { return takers_.contains(topic); }
  void publish(const std::string& topic, std::span<const std::byte> message, TimeNs now) const {
    const auto found = takers_.find(topic);
    if (found != takers_.end()) {
      for (const Take& take : found->second) {
        take(message, now);
      }
    }
  }

 private:
  std::map<std::string, std::vector<Take>> takers_;
};

/// The newest message of a topic, or its events. `pace` is the simulated time at which it came.
std::unique_ptr<Source> make_memory_sensor(MemoryTopics& topics, const SensorSpec& spec);

/// Commands leave by the rules of ros_command, all times simulated: nothing depends on the wall
/// clock.
std::unique_ptr<CommandEnd> make_memory_command(MemoryTopics& topics, const CommandSpec& spec);

}  // namespace spikeloop::fused
