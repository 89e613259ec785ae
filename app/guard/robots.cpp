#include "robots.hpp"

#include <fmt/format.h>

#include "spikeloop/core/error.hpp"

namespace spikeloop::guard {
namespace {

/// The adapter waits 5 s for our answer.
constexpr TimeNs kMasterTimeout = 3 * kNsPerSecond;

}  // namespace

std::unique_ptr<ros1::RawPublisher> Robots::advertise(const Hello& hello) {
  const std::lock_guard lock(mutex_);
  if (!session_) {
    session_ =
        std::make_unique<ros1::Session>(ros1::SessionSettings{.node_name = "spikeloop_guard",
                                                              .unique_name = true,
                                                              .master_uri = hello.master_uri,
                                                              .master_timeout = kMasterTimeout});
    master_uri_ = hello.master_uri;
  }
  if (hello.master_uri != master_uri_) {
    throw ConfigurationError(fmt::format(
        "it is with the ROS master at {}, not with that at {}; start another guard for this one",
        master_uri_, hello.master_uri));
  }
  return std::make_unique<ros1::RawPublisher>(*session_, hello.topic, hello.message_type);
}

}  // namespace spikeloop::guard
