// When the messages of a topic arrive, whatever is in them.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros_command {

/// Port: `out` [1], the monotonic time in s at which the newest message arrived.
class Arrivals : public Source {
 public:
  /// @throws ConfigurationError for an unknown type or an impossible topic.
  Arrivals(topics::Session& session, const std::string& topic, const std::string& message_type);

  std::vector<EndpointPort> ports() const override;
  void receive(const Step& step) override;

 private:
  std::atomic<TimeNs> newest_{0};  ///< 0: none has come
  TimeNs seen_ = 0;                ///< the loop's
  std::unique_ptr<topics::RawSubscriber> subscriber_;
};

}  // namespace spikeloop::ros_command
