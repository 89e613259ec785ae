#include "live_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "changes.hpp"
#include "spikeloop/core/background.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/core/priority.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/live/neural_messages.hpp"
#include "spikeloop/live/status.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::fused {
namespace {

using experiment::Experiment;
using experiment::Sync;
using nlohmann::json;

// Wall times.
constexpr TimeNs kFlushPeriod = kNsPerSecond / 50;
constexpr TimeNs kStatusPeriod = kNsPerSecond / 10;
constexpr TimeNs kWeightsPeriod = kNsPerSecond / 4;
constexpr std::chrono::milliseconds kLookPeriod{20};
constexpr std::size_t kMostSpikes = 65'536;  // of one message

std::string topic_of(const std::string& end) {
  return fmt::format("/{}/{}", experiment::node_of(end), experiment::port_of(end));
}

/// A clock does not wait for a process that stands still. With several processes one pause would
/// have to hold all of them; simulators wait for their only partner.
bool can_pause(const Experiment& experiment) {
  return (experiment.sync == Sync::lockstep || experiment.sync == Sync::unpaced) &&
         experiment.layout.processes.size() == 1;
}

bool has_commands(const Experiment& experiment, const std::string& process) {
  return std::ranges::any_of(experiment.nodes, [&](const experiment::Node& node) {
    return node.role == experiment::Role::sink && process_of(experiment, node.name) == process;
  });
}

bool asks_to_stop(const RunEvents& events) {
  return events.stop && events.stop();
}

/// The launcher learns that the run stands still on purpose.
class Waiting {
 public:
  explicit Waiting(const RunEvents& events) : events_(events) { tell(true); }
  ~Waiting() { tell(false); }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  void tell(bool waits) const {
    if (events_.waits) {
      events_.waits(waits);
    }
  }

  const RunEvents& events_;
};

void sleep_a_moment() {
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace

/// The newest message of a topic, passed on once in a while.
class ShownTopic {
 public:
  ShownTopic(live::Feed& feed, std::uint32_t channel) : feed_(feed), channel_(channel) {}

  void take(TimeNs time, std::span<const std::byte> message) {
    time_ = time;
    message_.assign(message.begin(), message.end());
    changed_ = true;
  }

  void flush() {
    if (std::exchange(changed_, false)) {
      feed_.publish(channel_, time_, message_);
    }
  }

 private:
  live::Feed& feed_;
  const std::uint32_t channel_;
  TimeNs time_ = 0;
  bool changed_ = false;
  std::vector<std::byte> message_;
};

/// Collects what an output puts out, and passes it on once in a while.
class ShownOutput {
 public:
  ShownOutput(live::Feed& feed, const std::string& end, PortKind kind)
      : feed_(feed),
        end_(end),
        kind_(kind),
        channel_(feed.add(kind == PortKind::spikes ? live::spike_channel(topic_of(end))
                                                   : live::signal_channel(topic_of(end)))) {}

  void take(const Step& step) {
    time_ = step.interval().end;
    if (kind_ == PortKind::spikes) {
      take_spikes(step.spike_input().spikes);
    } else if (const SignalInput input = step.signal_input(); input.revision != revision_) {
      revision_ = input.revision;
      values_.assign(input.values.begin(), input.values.end());
      if (!input.valid()) {
        std::ranges::fill(values_, std::numeric_limits<double>::quiet_NaN());
      }
      changed_ = true;
    }
  }

  void flush() {
    if (std::exchange(changed_, false)) {
      live::write_signal(values_, message_);
      feed_.publish(channel_, time_, message_);
    }
    if (!times_.empty()) {
      live::write_spikes(times_, channels_, message_);
      feed_.publish(channel_, time_, message_);
      times_.clear();
      channels_.clear();
    }
  }

  PortKind kind() const { return kind_; }
  const std::string& end() const { return end_; }
  std::uint64_t spikes() const { return spikes_; }

 private:
  void take_spikes(std::span<const Spike> spikes) {
    spikes_ += spikes.size();
    for (const Spike& spike : spikes) {
      times_.push_back(spike.time_ns);
      channels_.push_back(static_cast<std::uint32_t>(spike.channel));
      if (times_.size() == kMostSpikes) {
        flush();
      }
    }
  }

  live::Feed& feed_;
  const std::string end_;
  const PortKind kind_;
  const std::uint32_t channel_;
  TimeNs time_ = 0;
  std::uint64_t revision_ = 0;
  bool changed_ = false;
  std::vector<double> values_;
  std::uint64_t spikes_ = 0;
  std::vector<std::int64_t> times_;
  std::vector<std::uint32_t> channels_;
  std::vector<std::byte> message_;
};

namespace {

class ShowingSink : public Sink {
 public:
  ShowingSink(std::shared_ptr<ShownOutput> output, std::uint32_t width)
      : output_(std::move(output)), width_(width) {}
  std::vector<EndpointPort> ports() const override { return {{"in", output_->kind(), width_}}; }
  void send(const Step& step) override { output_->take(step); }

 private:
  std::shared_ptr<ShownOutput> output_;
  std::uint32_t width_;
};

}  // namespace

LiveView::LiveView(const std::string& folder, const Experiment& experiment,
                   const std::string& process)
    : feed_(folder, {.process = process,
                     .commands = has_commands(experiment, process),
                     .pausable = can_pause(experiment)}),
      process_(process),
      experiment_(experiment),
      pausable_(can_pause(experiment)),
      status_(feed_.add(live::status_channel())) {
  add_parameters(process);
}

LiveView::~LiveView() = default;

std::unique_ptr<Sink> LiveView::sink(const std::string& end, PortKind kind, std::uint32_t width) {
  outputs_.push_back(std::make_shared<ShownOutput>(feed_, end, kind));
  return std::make_unique<ShowingSink>(outputs_.back(), width);
}

topics::Keep LiveView::messages(const experiment::Node& node) {
  const messages::Schema schema =
      messages::schema_of(experiment_.dialect, node.parameters.text("message"));
  const std::uint32_t channel =
      feed_.add({node.parameters.text("topic"), schema.encoding, schema.type,
                 schema.definition_encoding, schema.definition});
  topics_.push_back(std::make_shared<ShownTopic>(feed_, channel));
  return [topic = topics_.back()](TimeNs time, std::span<const std::byte> message) {
    topic->take(time, message);
  };
}

std::function<void(TimeNs, double)> LiveView::value(const std::string& topic) {
  return [this, channel = feed_.add(live::signal_channel(topic)),
          message = std::vector<std::byte>()](TimeNs time, double value) mutable {
    live::write_signal(std::span(&value, 1), message);
    feed_.publish(channel, time, message);
  };
}

/// Sliders reach to four times the value at the begin, where the bounds allow it.
void LiveView::add_parameters(const std::string& process) {
  constexpr double kReach = 4;
  for (const experiment::Node& node : experiment_.nodes) {
    if (node.role != experiment::Role::node || process_of(experiment_, node.name) != process) {
      continue;
    }
    for (const ParameterDescription& parameter : node.node_class->description.parameters) {
      const std::string name = fmt::format("{}.{}", node.name, parameter.name);
      if (!parameter.changeable) {
        continue;
      }
      const double value = node.parameters.number(parameter.name);
      if (!feed_.add({name, value, parameter.minimum, parameter.maximum, parameter.unit})) {
        return;
      }
      parameters_.push_back({0, node.name, parameter.name, value});
      const double reach = std::max(1.0, kReach * std::abs(value));
      changeable_.push_back({{"name", name},
                             {"minimum", std::max(parameter.minimum, -reach)},
                             {"maximum", std::min(parameter.maximum, reach)},
                             {"unit", parameter.unit}});
    }
  }
}

void LiveView::before_tick(TimeNs time, Changes& changes, const RunEvents& events) {
  if (pausable_) {
    wait(time, events);
  }
  for (const auto& [number, value] : feed_.changes()) {
    parameters_[number].value = value;
    changes.make(parameters_[number]);
  }
}

void LiveView::show(const experiment::Change& change) {
  const auto known = std::ranges::find_if(parameters_, [&](const experiment::Change& each) {
    return each.node == change.node && each.parameter == change.parameter;
  });
  if (known != parameters_.end()) {
    feed_.set(static_cast<std::size_t>(known - parameters_.begin()), change.value);
  }
}

void LiveView::wait(TimeNs time, const RunEvents& events) {
  if (feed_.paused() && feed_.steps() == steps_) {
    const Waiting waiting(events);
    flush();
    while (feed_.paused() && feed_.steps() == steps_ && !asks_to_stop(events)) {
      if (wall_now() >= next_status_) {
        tell(progress_, false);
      }
      sleep_a_moment();
    }
    speed_since_wall_ = 0;
  }
  steps_ = feed_.paused() ? std::min(steps_ + 1, feed_.steps()) : feed_.steps();
  keep_to_speed(time, events);
}

void LiveView::keep_to_speed(TimeNs time, const RunEvents& events) {
  if (const double speed = feed_.speed(); speed != speed_ || speed_since_wall_ == 0) {
    speed_ = speed;
    speed_since_wall_ = wall_now();
    speed_since_ = time;
  }
  const auto ahead = [&] {
    const double due = static_cast<double>(time - speed_since_) / speed_;
    return static_cast<double>(wall_now() - speed_since_wall_) < due;
  };
  if (speed_ <= 0 || !ahead()) {
    return;
  }
  const Waiting waiting(events);
  while (ahead() && feed_.speed() == speed_ && !feed_.paused() && !asks_to_stop(events)) {
    if (wall_now() >= next_status_) {
      flush();
      tell(progress_, false);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

void LiveView::after_tick(const Progress& progress, TimeNs now) {
  progress_ = progress;
  if (now >= next_flush_) {
    next_flush_ = now + kFlushPeriod;
    flush();
  }
  if (now >= next_weights_) {
    next_weights_ = now + kWeightsPeriod;
    weights_->publish(progress.simulated);
  }
  if (now >= next_status_) {
    tell(progress, false);
  }
}

void LiveView::finish(const Progress& progress) {
  flush();
  weights_->publish(progress.simulated);
  tell(progress, true);
}

void LiveView::flush() {
  for (const auto& topic : topics_) {
    topic->flush();
  }
  for (const auto& output : outputs_) {
    output->flush();
  }
}

void LiveView::tell(const Progress& progress, bool ended) {
  next_status_ = wall_now() + kStatusPeriod;
  json status{{"process", process_},
              {"simulated_s", to_seconds(progress.simulated)},
              {"wall_s", to_seconds(progress.wall)},
              {"overruns", progress.overruns},
              {"paused", pausable_ && feed_.paused()},
              {"ended", ended},
              {"changeable", changeable_},
              {"commands", json::array()},
              {"spikes", json::object()}};
  for (const ros_command::CommandEndpoint* command : commands_) {
    static constexpr const char* kLevels[] = {"ok", "warning", "error"};
    const command::Condition condition = command->condition();
    status["commands"].push_back({{"node", command->node()},
                                  {"level", kLevels[static_cast<int>(condition.level)]},
                                  {"text", condition.text}});
  }
  for (const auto& output : outputs_) {
    if (output->kind() == PortKind::spikes) {
      status["spikes"][output->end()] = output->spikes();
    }
  }
  const std::string text = status.dump();
  feed_.publish(status_, progress.simulated, std::as_bytes(std::span(text)));
}

StopButton::StopButton(const live::Feed& feed, std::vector<ros_command::CommandEndpoint*> commands)
    : feed_(feed), commands_(std::move(commands)) {
  look();  // before the first tick
  thread_ = background_thread([this] { watch(); });
}

StopButton::~StopButton() {
  done_ = true;
  thread_.join();
}

void StopButton::look() {
  if (const bool now = feed_.stop_pressed(); now != pressed_) {
    pressed_ = now;
    for (ros_command::CommandEndpoint* command : commands_) {
      command->sink().press_stop(now);
    }
  }
}

void StopButton::watch() {
  run_before_others();
  while (!done_) {
    look();
    std::this_thread::sleep_for(kLookPeriod);
  }
}

}  // namespace spikeloop::fused
