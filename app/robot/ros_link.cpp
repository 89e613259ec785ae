#include "ros_link.hpp"

#include <mutex>
#include <utility>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/session/open.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::robot {
namespace {

/// One topic out. What nobody listens to is not even made.
template <typename Message>
class Topic {
 public:
  Topic(topics::Session& session, const std::string& name, const char* type)
      : message_(session.dialect()), publisher_(session.publisher(name, type)) {}

  template <typename Value>
  void publish(const Value& value) {
    if (publisher_->has_subscribers()) publisher_->publish(message_.write(value));
  }

 private:
  Message message_;
  std::unique_ptr<topics::RawPublisher> publisher_;
};

}  // namespace

class RosLink::Impl {
 public:
  Impl(const RunOptions& options, std::unique_ptr<topics::Session> session)
      : session_(std::move(session)),
        scan_(*session_, options.topic(options.scan_topic), kScanType),
        odometry_(*session_, options.topic(options.odometry_topic), kOdometryType),
        clock_(*session_, options.topic(options.clock_topic), kClockType),
        twist_(session_->dialect()),
        subscriber_(session_->subscriber({.topic = options.topic(options.command_topic),
                                          .message_type = kTwistType,
                                          .take = [this](auto message) { receive(message); }})) {}

  void publish(const vehicle::LaserScan& scan) { scan_.publish(scan); }
  void publish(const vehicle::Odometry& odometry) { odometry_.publish(odometry); }
  void publish_clock(TimeNs time) { clock_.publish(time); }

  std::optional<Command> take_command() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(newest_, std::nullopt);
  }
  std::uint64_t commands() const { return commands_; }
  bool alive() const { return session_->alive(); }

 private:
  void receive(std::span<const std::byte> message) {
    try {
      const Command command = twist_.read(message);
      const std::scoped_lock lock(mutex_);
      newest_ = command;
      ++commands_;
    } catch (const Error& error) {
      log::warning("a command was left out: {}", error.what());
    }
  }

  std::unique_ptr<topics::Session> session_;
  Topic<ScanMessage> scan_;
  Topic<OdometryMessage> odometry_;
  Topic<ClockMessage> clock_;
  TwistReader twist_;
  std::mutex mutex_;
  std::optional<Command> newest_;
  std::atomic<std::uint64_t> commands_ = 0;
  std::unique_ptr<topics::RawSubscriber>
      subscriber_;  // the last: what its callback uses is there before it
};

std::unique_ptr<topics::Session> open_session(const RunOptions& options,
                                              const topics::RosArguments& arguments,
                                              const std::atomic<bool>& stop) {
  session::Settings settings;
  settings.ros = topics::dialect_of(options.ros);
  settings.node_name = options.node_name;
  settings.arguments = arguments;
  settings.master_timeout = from_seconds(options.master_timeout_s);
  settings.cancelled = &stop;
  return session::open(settings);
}

RosLink::RosLink(const RunOptions& options, std::unique_ptr<topics::Session> session)
    : impl_(std::make_unique<Impl>(options, std::move(session))) {}

RosLink::~RosLink() = default;

void RosLink::publish(const vehicle::LaserScan& scan) {
  impl_->publish(scan);
}
void RosLink::publish(const vehicle::Odometry& odometry) {
  impl_->publish(odometry);
}
void RosLink::publish_clock(TimeNs time) {
  impl_->publish_clock(time);
}
std::optional<Command> RosLink::take_command() {
  return impl_->take_command();
}
std::uint64_t RosLink::commands() const {
  return impl_->commands();
}
bool RosLink::alive() const {
  return impl_->alive();
}

}  // namespace spikeloop::robot
