#include "clock_pacer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/units.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/topics/names.hpp"
#include "spikeloop/topics/other_types.hpp"

namespace spikeloop {
namespace {

constexpr const char* kTopic = "/clock";
constexpr const char* kType = "rosgraph_msgs/Clock";
constexpr TimeNs kSilence = 3 * kNsPerSecond;  // wall time
constexpr TimeNs kNone = -1;
constexpr std::size_t kSteps = 11;  // intervals of /clock after which its period is known

TimeNs rounded(TimeNs time, TimeNs unit) {
  return (time + unit / 2) / unit * unit;
}

class ClockPacer : public Pacer {
 public:
  ClockPacer(topics::Session& session, TimeNs tick, Waiting& waiting, std::function<void()> alive)
      : session_(session),
        tick_(tick),
        waiting_(waiting),
        alive_(std::move(alive)),
        seconds_(messages::Catalog::for_type(session.dialect(), kType), kType, "clock.secs"),
        nanoseconds_(messages::Catalog::for_type(session.dialect(), kType), kType, "clock.nsecs"),
        subscriber_(session.subscriber(
            {.topic = kTopic,
             .message_type = kType,
             .queue = 1,  // the newest is enough, as for the nodes of rclcpp
             .take = [this](auto message) { take(message); },
             .refuse = [this](const auto& other) { other_types_.add(other); }})) {}

  void start() override { started_ = wall_now(); }

  void wait_until(TimeNs time) override {
    const auto shown = [&] { return newest_ != kNone && newest_ - first_ >= time; };
    told_ = false;
    const bool first = newest_ == kNone;
    const bool goes_on = waiting_.until([&] { return went_back_ || shown(); },
                                        [&](TimeNs waited) { meanwhile(waited); });
    refuse_jump_back();
    if (!goes_on) {
      return;
    }
    if (told_) {
      log::info("{}", first ? fmt::format("first message on {}", kTopic)
                            : fmt::format("{} continues", kTopic));
    }
    if (report_.ticks++ == 0) {
      started_ = wall_now();
    }
    const TimeNs period = period_;
    report_.overruns += newest_ - first_ - time > std::max(tick_, period + period / 2) ? 1 : 0;
    if (!compared_ && period_known_) {
      compare_with_tick(period);
    }
  }

  Report report() const override {
    Report report = report_;
    report.wall_time = wall_now() - started_;
    return report;
  }

 private:
  /// In the session's thread.
  void take(std::span<const std::byte> message) {
    std::vector<double> values;
    try {
      seconds_.read(message, values);
      nanoseconds_.read(message, values);
    } catch (const Error& error) {
      log::warning("topic '{}': {}", kTopic, error.what());
      return;
    }
    const TimeNs now =
        static_cast<TimeNs>(values.at(0)) * kNsPerSecond + static_cast<TimeNs>(values.at(1));
    if (newest_ == kNone) {
      first_ = now;
    } else if (now < newest_ && !went_back_) {
      back_to_ = now;
      went_back_ = true;
    } else if (now > newest_) {
      note_step(now - newest_);
    }
    if (!went_back_) {
      newest_ = now;
    }
    waiting_.notify();
  }

  /// In the session's thread. The lower quartile of the first steps is right even if the clock
  /// jumps or messages are lost.
  void note_step(TimeNs step) {
    if (steps_.size() < kSteps) {
      steps_.insert(std::ranges::upper_bound(steps_, step), step);
      period_ = steps_[steps_.size() / 4];
      period_known_ = steps_.size() == kSteps;
    }
  }

  void compare_with_tick(TimeNs period) {
    compared_ = true;
    if (period > tick_ + tick_ / 2) {
      log::info("{} has a period of {}, a tick is {}: {} ticks are computed at a time", kTopic,
                format_time(rounded(period, kNsPerSecond / 1'000'000)), format_time(tick_),
                format_rounded(static_cast<double>(period) / static_cast<double>(tick_), 3));
    }
  }

  void refuse_jump_back() const {
    if (went_back_) {
      throw TransportError(with_code(
          Code::partner_failed,
          "{} went back from {} to {}: the simulator was set back, or two programs publish it "
          "('{} info {}'); run the experiment again from the simulator's new beginning",
          kTopic, format_time(newest_), format_time(back_to_),
          topics::topic_command(session_.dialect()), kTopic));
    }
  }

  /// A simulator that is paused is waited for; one that has gone brings no time any more.
  void refuse_lost_publisher(TimeNs waited) const {
    const TimeNs patience = waiting_.patience();
    if (newest_ != kNone && patience > 0 && waited > patience && !subscriber_->has_publishers()) {
      throw TransportError(with_code(
          Code::partner_failed,
          "{} stands still at {} for {}, and has no publisher any more: the "
          "simulator has ended, or the node that sends it; start it again, then the "
          "experiment",
          kTopic, format_time(rounded(newest_, kNsPerSecond / 1000)), format_time(patience)));
    }
  }

  /// True if a simulator may be paused: its publisher is connected, and sends nothing.
  bool has_publisher() const {
    return subscriber_->has_publishers() && (!session_.has_warned_of_unreachable_node(kTopic) ||
                                             session_.is_connected_to_publisher(kTopic));
  }

  void report_other_types() {
    while (const auto other = other_types_.take()) {
      if (newest_ == kNone) {
        throw TransportError(
            with_code(Code::wrong_message,
                      "sync: sim_time: {}; stop that node, or write  sync: realtime", other->text));
      }
      log::warning("{}; its messages are ignored", other->text);
    }
  }

  void refuse_silence(TimeNs waited) const {
    const TimeNs patience = waiting_.start_patience();
    if (newest_ == kNone && waited > patience && !has_publisher()) {
      throw TransportError(with_code(Code::partner_missing,
                                     "sync: sim_time: no message on {} within {}: {}", kTopic,
                                     format_time(patience), reason_for_silence()));
    }
  }

  const char* reason_for_silence() const {
    if (session_.has_warned_of_unreachable_node(kTopic)) {
      return "its publisher cannot be connected; start the simulator again, or do what the warning "
             "above says";
    }
    return "it has no publisher; start the simulator, or write  sync: realtime";
  }

  void meanwhile(TimeNs waited) {
    alive_();
    session_.require_alive();
    report_other_types();
    refuse_silence(waited);
    refuse_lost_publisher(waited);
    if (told_ || waited < kSilence) {
      return;
    }
    told_ = true;
    if (newest_ == kNone && has_publisher()) {
      log::warning(
          "no message on {} for {}, which has a publisher: is the simulator paused? The experiment "
          "waits",
          kTopic, format_time(kSilence));
    } else if (newest_ == kNone) {
      log::warning(
          "no message on {} for {}, and sync: sim_time waits for it: is use_sim_time set, and "
          "does the simulator publish {}? '{} hz {}' shows it",
          kTopic, format_time(kSilence), kTopic, topics::topic_command(session_.dialect()), kTopic);
    } else {
      log::warning("{} has stood still at {} for {}: is the simulator paused? The experiment waits",
                   kTopic, format_time(rounded(newest_, kNsPerSecond / 1000)),
                   format_time(kSilence));
    }
  }

  topics::Session& session_;
  TimeNs tick_;
  Waiting& waiting_;
  std::function<void()> alive_;
  messages::FieldReader seconds_;
  messages::FieldReader nanoseconds_;
  topics::OtherTypes other_types_;
  Report report_;
  TimeNs started_ = 0;
  bool told_ = false;
  bool compared_ = false;
  std::vector<TimeNs> steps_;  // used by the session's thread only
  std::atomic<TimeNs> period_{0};
  std::atomic<bool> period_known_{false};
  std::atomic<TimeNs> first_{0};
  std::atomic<TimeNs> newest_{kNone};
  std::atomic<TimeNs> back_to_{0};
  std::atomic<bool> went_back_{false};
  std::unique_ptr<topics::RawSubscriber>
      subscriber_;  // the last: what its callback uses is there before it
};

}  // namespace

std::unique_ptr<Pacer> make_clock_pacer(topics::Session& session, TimeNs tick, Waiting& waiting,
                                        std::function<void()> alive) {
  return std::make_unique<ClockPacer>(session, tick, waiting, std::move(alive));
}

}  // namespace spikeloop
