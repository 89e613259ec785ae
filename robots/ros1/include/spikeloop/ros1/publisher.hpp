// Command messages from components' values.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/ros1/session.hpp"

namespace spikeloop::ros1 {

class Publisher {
 public:
  /// @param fields a path a value; a single path to a variable array, like `data`, takes all values
  /// @throws ConfigurationError: unknown type or fields, an impossible topic.
  Publisher(Session& session, const std::string& topic, const std::string& message_type,
            const std::vector<std::string>& fields);
  ~Publisher();
  /// Throws what the constructor would, without ROS.
  static void check(const std::string& topic, const std::string& message_type,
                    const std::vector<std::string>& fields);
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// One message with these values, all other fields zero; as RawPublisher::publish.
  void publish(std::span<const double> values);
  /// As RawPublisher::drain.
  void drain() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::ros1
