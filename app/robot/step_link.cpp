#include "step_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::robot {
namespace {

constexpr std::chrono::milliseconds kPeriod{20};  // how often a stop is looked for
constexpr std::chrono::seconds kEndFollows{1};
/// Less than the experiment waits for an answer: it shall hear what is missing.
constexpr std::chrono::seconds kPatience{50};

}  // namespace

StepLink::StepLink(const RunOptions& options, topics::Session& session,
                   const std::vector<SensorTopic>& sensors, const CommandTopic& command)
    : session_(session),
      clock_message_(session.dialect()),
      clock_(session.publisher(options.topic(options.clock_topic), kClockType)),
      answers_(session.publisher(stepping::kSteppedTopic, stepping::kType, 0)),
      command_topic_(session.whole_topic(options.command_topic_of(command))) {
  for (const SensorTopic& sensor : sensors) {
    const std::string topic = options.sensor_topic(sensor.name);
    const std::uint32_t queue = sensor.latched() ? 1 : 0;
    sensors_.push_back({.name = session.whole_topic(topic),
                        .publisher = session.publisher(topic, sensor.type, queue, sensor.latched()),
                        .latched = sensor.latched()});
  }
  command_subscriber_ = session.subscriber({.topic = command_topic_,
                                            .message_type = command.type(),
                                            .queue = 0,
                                            .take = [this](auto message) { take(message); }});
  request_subscriber_ =
      session.subscriber({.topic = stepping::kStepTopic,
                          .message_type = stepping::kType,
                          .queue = 0,
                          .take = [this](auto message) { take_request(message); }});
}

void StepLink::take(std::span<const std::byte> command) {
  {
    const std::lock_guard lock(mutex_);
    newest_.emplace(command.begin(), command.end());
    ++commands_;
  }
  come_.notify_one();
}

void StepLink::take_request(std::span<const std::byte> message) {
  {
    const std::lock_guard lock(mutex_);
    try {
      requests_.push_back(stepping::text_of(session_.dialect(), message));
    } catch (const Error& error) {
      log::warning("topic {}: {}", stepping::kStepTopic, error.what());
    }
  }
  come_.notify_one();
}

template <typename Done>
bool StepLink::wait(const std::atomic<bool>& stop, Done&& done) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  std::unique_lock lock(mutex_);
  while (!done()) {
    if (stop || !alive() || std::chrono::steady_clock::now() > end) {
      return false;
    }
    come_.wait_for(lock, kPeriod);
  }
  return true;
}

std::optional<stepping::Request> StepLink::next(const std::atomic<bool>& stop) {
  while (!stop && alive()) {
    if (!wait(stop, [this] { return !requests_.empty(); })) {
      continue;
    }
    std::string text;
    {
      const std::lock_guard lock(mutex_);
      text = std::move(requests_.front());
      requests_.pop_front();
    }
    try {
      return stepping::read_request(text);
    } catch (const Error& error) {
      refuse(error.what());
    }
  }
  return std::nullopt;
}

void StepLink::begin(const std::vector<std::string>& sensors) {
  const std::lock_guard lock(mutex_);
  commands_ = 0;
  newest_.reset();
  for (Topic& sensor : sensors_) {
    sensor.taken = std::ranges::find(sensors, sensor.name) != sensors.end();
    sensor.count = sensor.latched && sensor.sent ? 1 : 0;
  }
}

bool StepLink::wanted(std::size_t sensor) const {
  const Topic& topic = sensors_[sensor];
  return topic.latched ? !topic.sent : topic.taken || topic.publisher->has_subscribers();
}

void StepLink::publish(std::size_t sensor, std::span<const std::byte> message) {
  sensors_[sensor].publisher->publish(message);
  sensors_[sensor].sent = true;
  ++sensors_[sensor].count;
}

std::optional<StepLink::Bytes> StepLink::take_command(const stepping::Counts& sent,
                                                      const std::atomic<bool>& stop,
                                                      std::string& problem) {
  const auto found = sent.find(command_topic_);
  const std::uint64_t wanted = found == sent.end() ? 0 : found->second;
  wait(stop, [&] { return commands_ >= wanted; });
  std::unique_lock lock(mutex_);
  // One more may be the zero of an experiment that is being stopped: its end follows at once.
  const bool ends = commands_ > wanted &&
                    come_.wait_for(lock, kEndFollows, [this] { return !requests_.empty(); });
  if (commands_ != wanted && !ends) {
    problem = fmt::format(
        "{} commands were sent on {}, but {} arrived{}", wanted, command_topic_, commands_.load(),
        commands_ > wanted ? fmt::format("; look for another publisher with  {} info {}",
                                         topics::topic_command(session_.dialect()), command_topic_)
                           : "");
  }
  return std::exchange(newest_, std::nullopt);
}

void StepLink::publish_clock(TimeNs time) {
  if (clock_->has_subscribers()) {
    clock_->publish(clock_message_.write(time));
  }
}

void StepLink::answer(TimeNs time) {
  stepping::Answer answer{.time = time};
  for (const Topic& sensor : sensors_) {
    if (sensor.taken || (sensor.count > 0 && !sensor.latched))
      answer.published[sensor.name] = sensor.count;
  }
  answers_->publish(stepping::string_message(session_.dialect(), to_text(answer)));
}

void StepLink::refuse(const std::string& problem) {
  log::warning("{}", problem);
  answers_->publish(
      stepping::string_message(session_.dialect(), to_text(stepping::Answer{.error = problem})));
}

}  // namespace spikeloop::robot
