#include "stepping_link.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstddef>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop {
namespace {

using stepping::Answer;
using stepping::Request;

constexpr TimeNs kFirstWord = 3 * kNsPerSecond;  // wall time
constexpr TimeNs kRepeat = kNsPerSecond;
constexpr std::uint32_t kAll = 0;
constexpr TimeNs kDiscovery =
    5 * kNsPerSecond;                // wall time; Fast DDS repeats lost packets after 3 s
constexpr int kMostDeliveries = 20;  // calls of deliver(), each at most 100 ms

/// No other run with this robot has it.
std::uint64_t number_of_run() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(now).count());
}

/// A robot may answer each `begin` of a run; one answer is enough.
bool is_of_begin(const Answer& answer) {
  return answer.error.empty() && answer.time == 0;
}

}  // namespace

SteppingLink::SteppingLink(topics::Session& session, TimeNs tick, Waiting& waiting)
    : session_(session),
      tick_(tick),
      waiting_(waiting),
      steps_(session.publisher(stepping::kStepTopic, stepping::kType, kAll)),
      answers_(session.subscriber({.topic = stepping::kSteppedTopic,
                                   .message_type = stepping::kType,
                                   .queue = kAll,
                                   .take = [this](auto message) { take(message); }})) {}

/// In the session's thread.
void SteppingLink::take(std::span<const std::byte> message) {
  {
    const std::lock_guard lock(mutex_);
    try {
      Answer answer = stepping::read_answer(stepping::text_of(session_.dialect(), message));
      if (repeated_ && asked_for_ != 0 && is_of_begin(answer)) {
        return;
      }
      answer_ = std::move(answer);
    } catch (const Error& error) {
      unreadable_ = error.what();
    }
  }
  waiting_.notify();
}

void SteppingLink::send(const Request& request) {
  steps_->publish(stepping::string_message(session_.dialect(), to_text(request)));
}

void SteppingLink::require_sound() const {
  session_.require_alive();
  for (const SteppedTopic& topic : sensors_) {
    topic.require_sound();
  }
}

/// Once the publisher knows us, nothing is lost; until then our side alone may think so.
bool SteppingLink::is_subscribed(bool connected, const std::string& topic) {
  if (connected && unknown_.contains(topic) && session_.publishers_are_connected(topic)) {
    unknown_.erase(topic);
  }
  return connected && !unknown_.contains(topic);
}

/// What is not connected yet.
std::string SteppingLink::missing_connections() {
  std::vector<std::string> missing;
  const auto look = [&](bool connected, const char* who, const std::string& topic) {
    if (!connected) {
      missing.push_back(fmt::format("a {} of {}", who, topic));
    }
  };
  look(steps_->has_subscribers(), "subscriber", stepping::kStepTopic);
  look(is_subscribed(answers_->has_publishers(), stepping::kSteppedTopic), "publisher",
       stepping::kSteppedTopic);
  for (const SteppedTopic& topic : sensors_) {
    look(is_subscribed(topic.connected(), topic.name), "publisher", topic.name);
  }
  for (const SteppedTopic& topic : commands_) {
    look(topic.connected(), "subscriber", topic.name);
  }
  return fmt::format("{}", fmt::join(missing, ", "));
}

void SteppingLink::begin() {
  if (!meet()) {
    return;
  }
  Request request{.kind = Request::Kind::begin, .run = number_of_run(), .tick = tick_};
  for (const SteppedTopic& topic : sensors_) {
    if (std::ranges::find(request.sensors, topic.name) == request.sensors.end()) {
      request.sensors.push_back(topic.name);  // two parts of the process may read one topic
    }
  }
  for (const SteppedTopic& topic : commands_) {
    request.commands.push_back(topic.name);
  }
  begun_ = true;
  ask(request);
  if (const std::optional<Answer> given = answer(); given && !given->subscribers.empty()) {
    await_subscribers(given->subscribers);
  }
}

/// Waits until everybody is connected.
bool SteppingLink::meet() {
  bool told = false;
  return waiting_.until(
      [this] { return missing_connections().empty(); },
      [&](TimeNs waited) {
        require_sound();
        const std::string missing = missing_connections();
        if (!missing.empty() && waiting_.patience() != 0 && waited > waiting_.patience()) {
          throw TransportError(with_code(
              Code::partner_missing,
              "no robot has come that can be stepped: for {} there has not been {}; start "
              "spikeloop-robot --step, or a robot that speaks the protocol of docs/stepping.md, or "
              "write  sync: realtime",
              format_time(waiting_.patience()), missing));
        }
        if (!missing.empty() && !told && waited > kFirstWord) {
          told = true;
          log::warning("sync: lockstep waits for {}; see docs/stepping.md", missing);
        }
      });
}

std::string SteppingLink::missing_subscribers(const stepping::Counts& expected) const {
  std::vector<std::string> missing;
  for (const SteppedTopic& topic : commands_) {
    const auto found = expected.find(topic.name);
    const std::size_t known = session_.subscribers(topic.name).size();
    if (found != expected.end() && known < found->second) {
      missing.push_back(fmt::format("{} of {} subscribers of {}", found->second - known,
                                    found->second, topic.name));
    }
  }
  return fmt::format("{}", fmt::join(missing, ", "));
}

/// Waits until as many subscribers of each command are known as to the program that steps the
/// simulator. That program meets the experiment first if the discovery of the simulator is late;
/// the simulator would then step without commands.
void SteppingLink::await_subscribers(const stepping::Counts& expected) {
  bool late = false;
  waiting_.until([&] { return late || missing_subscribers(expected).empty(); },
                 [&](TimeNs waited) {
                   require_sound();
                   late = waited > kDiscovery;
                 });
  if (late) {
    log::warning(
        "{} cannot be found; the simulator may step without commands, and runs may differ. Has a "
        "program that subscribes to them been killed?",
        missing_subscribers(expected));
  }
}

/// Waits until all reliable subscribers have confirmed the commands. A simulator steps with the
/// commands that it has, and may lack those that the program has that steps it.
void SteppingLink::deliver_commands() {
  for (const SteppedTopic& topic : commands_) {
    bool delivered = false;
    for (int i = 0; i < kMostDeliveries && !delivered; ++i) {
      delivered = topic.deliver();
    }
    if (!delivered && !std::exchange(told_undelivered_, true)) {
      log::warning(
          "a subscriber of {} does not confirm commands; the simulator may step without them, and "
          "runs may differ. Is a program that subscribes to it stopped?",
          topic.name);
    }
  }
}

void SteppingLink::advance(TimeNs time) {
  if (counts_for_another_ && !told_undelivered_) {
    deliver_commands();
  }
  Request request{.to = time};
  for (const SteppedTopic& topic : commands_) {
    request.sent[topic.name] = topic.count();
  }
  ask(request);
}

std::optional<Answer> SteppingLink::answer() {
  const std::lock_guard lock(mutex_);
  if (!unreadable_.empty()) {
    throw TransportError(unreadable_);
  }
  return answer_;
}

bool SteppingLink::has_come(const Answer& answer) const {
  return missing_messages(answer).empty();
}

/// What the robot says it has published, and is not here yet.
std::string SteppingLink::missing_messages(const Answer& answer) const {
  std::vector<std::string> missing;
  for (const SteppedTopic& topic : sensors_) {
    const auto published = answer.published.find(topic.name);
    const std::uint64_t count = published == answer.published.end() ? 0 : published->second;
    if (topic.count() < count) {
      missing.push_back(
          fmt::format("{} of {} messages on {}", count - topic.count(), count, topic.name));
    }
  }
  return fmt::format("{}", fmt::join(missing, ", "));
}

void SteppingLink::check(const Answer& answer) const {
  if (!answer.error.empty()) {
    const std::string what =
        asked_for_ == 0 ? "begin" : fmt::format("step to {}", format_time(asked_for_));
    throw TransportError(
        with_code(Code::partner_failed, "the robot cannot {}: {}", what, answer.error));
  }
  if (answer.time != asked_for_) {
    throw TransportError(with_code(
        Code::partner_failed,
        "the robot stands at {} ns instead of {} ns; it has to advance exactly to to_ns, and one "
        "robot alone answers on {} (docs/stepping.md)",
        answer.time, asked_for_, stepping::kSteppedTopic));
  }
  for (const SteppedTopic& topic : sensors_) {
    const auto published = answer.published.find(topic.name);
    if (published == answer.published.end()) {
      throw TransportError(with_code(
          Code::partner_failed,
          "the robot's answer does not count the messages on {}; write it into 'published', with 0 "
          "as long as there is none (docs/stepping.md)",
          topic.name));
    }
    if (topic.count() > published->second && !answer.at_least) {
      throw TransportError(with_code(
          Code::partner_failed,
          "{} messages arrived on {}, but the robot published {}; look for another publisher with  "
          "{} info {}",
          topic.count(), topic.name, published->second, topics::topic_command(session_.dialect()),
          topic.name));
    }
  }
}

/// Sends a request and waits until it is answered, and all that the robot says it has published is
/// here.
void SteppingLink::ask(const Request& request) {
  {
    const std::lock_guard lock(mutex_);
    asked_for_ = request.to;
    answer_.reset();
  }
  repeat_at_ = kRepeat;
  send(request);
  const auto done = [this] {
    const std::lock_guard lock(mutex_);
    return !unreadable_.empty() || (answer_ && (!answer_->error.empty() || has_come(*answer_)));
  };
  const auto meanwhile = [&](TimeNs waited) {
    require_sound();
    const auto come = answer();
    if (waiting_.patience() == 0 || waited <= waiting_.patience()) {
      if (!come && request.kind == Request::Kind::begin) {
        repeat(request, waited);
      }
      return;
    }
    throw TransportError(
        come
            ? with_code(Code::partner_missing, "{} of {} have not come within {}",
                        missing_messages(*come), format_time(asked_for_),
                        format_time(waiting_.patience()))
            : fmt::format("the robot has not answered on {} within {} when it was to advance to {}",
                          stepping::kSteppedTopic, format_time(waiting_.patience()),
                          format_time(asked_for_)));
  };
  if (waiting_.until(done, meanwhile)) {
    const Answer given = answer().value();
    check(given);
    counts_for_another_ = given.at_least;
  }
}

/// The robot, or its answer, may not have been heard, as the first message between two nodes.
void SteppingLink::repeat(const Request& request, TimeNs waited) {
  if (waited >= repeat_at_) {
    {
      const std::lock_guard lock(mutex_);
      repeated_ = true;
    }
    repeat_at_ = waited + kRepeat;
    send(request);
  }
}

void SteppingLink::end() {
  if (begun_) {
    send({.kind = Request::Kind::end});
    steps_->drain();
  }
}

}  // namespace spikeloop
