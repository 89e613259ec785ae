#include "ros_link.hpp"

#include <mutex>
#include <utility>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/session/open.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::robot {
class RosLink::Impl {
 public:
  Impl(const RunOptions& options, topics::Session& session, const std::vector<SensorTopic>& sensors,
       const CommandTopic& command)
      : session_(session),
        clock_message_(session.dialect()),
        clock_(session.publisher(options.topic(options.clock_topic), kClockType)),
        command_(command) {
    for (const SensorTopic& sensor : sensors) {
      const std::string topic = options.sensor_topic(sensor.name);
      sensors_.push_back(sensor.latched() ? session.publisher(topic, sensor.type, 1, true)
                                          : session.publisher(topic, sensor.type));
      latched_.push_back(sensor.latched());
    }
    subscriber_ = session.subscriber({.topic = options.command_topic_of(command),
                                      .message_type = command.type(),
                                      .take = [this](auto message) { receive(message); }});
  }

  bool wanted(std::size_t sensor) const {
    return latched_[sensor] || sensors_[sensor]->has_subscribers();
  }
  void publish(std::size_t sensor, std::span<const std::byte> message) {
    sensors_[sensor]->publish(message);
  }
  void publish_clock(TimeNs time) {
    if (clock_->has_subscribers()) clock_->publish(clock_message_.write(time));
  }

  std::optional<std::vector<double>> take_command() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(newest_, std::nullopt);
  }
  std::uint64_t commands() const { return commands_; }
  bool alive() const { return session_.alive(); }

 private:
  void receive(std::span<const std::byte> message) {
    try {
      std::vector<double> numbers = command_.read(message);
      const std::scoped_lock lock(mutex_);
      newest_ = std::move(numbers);
      ++commands_;
    } catch (const Error& error) {
      log::warning("a command was left out: {}", error.what());
    }
  }

  topics::Session& session_;
  std::vector<std::unique_ptr<topics::RawPublisher>> sensors_;
  std::vector<bool> latched_;  // of each of them
  ClockMessage clock_message_;
  std::unique_ptr<topics::RawPublisher> clock_;
  const CommandTopic& command_;
  std::mutex mutex_;
  std::optional<std::vector<double>> newest_;
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

RosLink::RosLink(const RunOptions& options, topics::Session& session,
                 const std::vector<SensorTopic>& sensors, const CommandTopic& command)
    : impl_(std::make_unique<Impl>(options, session, sensors, command)) {}

RosLink::~RosLink() = default;

bool RosLink::wanted(std::size_t sensor) const {
  return impl_->wanted(sensor);
}
void RosLink::publish(std::size_t sensor, std::span<const std::byte> message) {
  impl_->publish(sensor, message);
}
void RosLink::publish_clock(TimeNs time) {
  impl_->publish_clock(time);
}
std::optional<std::vector<double>> RosLink::take_command() {
  return impl_->take_command();
}
std::uint64_t RosLink::commands() const {
  return impl_->commands();
}
bool RosLink::alive() const {
  return impl_->alive();
}

}  // namespace spikeloop::robot
