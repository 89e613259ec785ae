#include "memory_topics.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "spikeloop/command/command_feed.hpp"
#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/command/mapping.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/messages/event_playback.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"

namespace spikeloop::fused {
namespace {

using command::StopReason;

class MemorySensor : public Source {
 public:
  MemorySensor(MemoryTopics& topics, const SensorSpec& spec)
      : topic_(spec.part.parameters.text("topic")),
        initial_(experiment::sensor_initial(spec.part.parameters)),
        conversion_(messages::Catalog::for_type(messages::Dialect::ros1,
                                                spec.part.parameters.text("message")),
                    spec.part.parameters.text("message"),
                    experiment::sensor_rule(spec.part.parameters), spec.width, true),
        keep_(spec.keep) {
    topics.subscribe(topic_, [this](auto message, TimeNs now) { take(message, now); });
  }

  std::vector<EndpointPort> ports() const override {
    const auto width = static_cast<std::uint32_t>(conversion_.channels().size());
    return {{"out", PortKind::signal, width}, {"pace", PortKind::signal, 1}};
  }

  void receive(const Step& step) override {
    const SignalOutput out = step.signal_output(0);
    if (initial_) {
      std::ranges::fill(out.values(), *initial_);
      out.commit();
      initial_.reset();
    }
    if (!fresh_) {
      return;
    }
    fresh_ = false;
    std::ranges::copy(conversion_.channels(), out.values().begin());
    out.commit();
    const SignalOutput pace = step.signal_output(1);
    pace.values()[0] = to_seconds(arrived_);
    pace.commit();
  }

  std::vector<Counter> counters() const override {
    const auto& counts = conversion_.counts();
    return {{"messages", counts.messages},
            {"invalid_readings", counts.invalid_readings},
            {"without_reading", counts.without_reading},
            {"malformed", counts.malformed}};
  }

 private:
  void take(std::span<const std::byte> message, TimeNs now) {
    if (keep_) {
      keep_(now, message);
    }
    if (conversion_.convert(message)) {
      arrived_ = now;
      fresh_ = true;
    }
    if (const std::string warning = conversion_.take_warning(); !warning.empty()) {
      log::warning("topic '{}': {}", topic_, warning);
    }
  }

  std::string topic_;
  std::optional<double> initial_;
  messages::SensorConversion conversion_;
  Keep keep_;
  TimeNs arrived_ = 0;
  bool fresh_ = false;
};

/// Nothing comes before the run begins, and so nothing is left out.
class MemoryEventSensor : public Source {
 public:
  MemoryEventSensor(MemoryTopics& topics, const SensorSpec& spec)
      : topic_(spec.part.parameters.text("topic")),
        settings_(settings_of(spec)),
        conversion_(settings_, messages::Dialect::ros1),
        playback_(from_seconds(spec.part.parameters.number("latency"))),
        keep_(spec.keep) {
    topics.subscribe(topic_, [this](auto message, TimeNs now) { take(message, now); });
  }

  std::vector<EndpointPort> ports() const override {
    return {{"out", PortKind::spikes, settings_.width}, {"pace", PortKind::signal, 1}};
  }

  void receive(const Step& step) override {
    step.spike_output().emit(playback_.step(fresh_, step.interval()));
    if (!fresh_.empty()) {
      const SignalOutput pace = step.signal_output();
      pace.values()[0] = to_seconds(step.interval().begin);
      pace.commit();
    }
    fresh_.clear();
  }

  std::vector<Counter> counters() const override {
    const auto& counts = conversion_.counts();
    return {{"messages", counts.messages},
            {"events", counts.events},
            {"left_out", counts.left_out},
            {"refractory", counts.refractory},
            {"outside_camera", counts.outside_camera},
            {"waiting", playback_.waiting()},
            {"late_events", playback_.late()},
            {"worst_lateness_ns", static_cast<std::uint64_t>(playback_.worst_lateness())},
            {"clock_jumps", playback_.clock_jumps()},
            {"malformed", counts.malformed}};
  }

 private:
  static messages::EventSettings settings_of(const SensorSpec& spec) {
    messages::EventSettings settings = experiment::event_settings(spec.part.parameters);
    settings.width = spec.width;
    return settings;
  }

  void take(std::span<const std::byte> message, TimeNs now) {
    if (keep_) {
      keep_(now, message);
    }
    messages::EventMessage events;
    if (conversion_.convert(message, events)) {
      fresh_.push_back(std::move(events));
    }
    if (const std::string warning = conversion_.take_warning(); !warning.empty()) {
      log::warning("topic '{}': {}", topic_, warning);
    }
  }

  std::string topic_;
  messages::EventSettings settings_;
  messages::EventConversion conversion_;
  messages::EventPlayback playback_;
  Keep keep_;
  std::vector<messages::EventMessage> fresh_;  ///< since the last tick
};

command::CommandSettings settings_of(const CommandSpec& spec) {
  auto settings = command::simulated_settings(spec.part.parameters, spec.map,
                                              command::CommandClock::lockstep, spec.with_pace);
  add_safety(spec, settings);
  return settings;
}

class MemoryCommand : public CommandEnd {
 public:
  MemoryCommand(MemoryTopics& topics, const CommandSpec& spec)
      : MemoryCommand(topics, spec, settings_of(spec)) {}

  MemoryCommand(MemoryTopics& topics, const CommandSpec& spec,
                const command::CommandSettings& settings)
      : topics_(topics),
        name_(spec.part.name),
        from_(spec.from),
        topic_(spec.part.parameters.text("topic")),
        all_channels_(spec.part.mapping.all_channels),
        writer_(
            messages::Catalog::for_type(messages::Dialect::ros1, spec.part.mapping.message_type),
            spec.part.mapping.message_type, command::field_paths(spec.part.mapping)),
        settings_(settings),
        channel_(command::channel_settings(settings), [this](auto values) { publish(values); }),
        feed_(command::feed_settings(settings), channel_),
        keep_(spec.keep) {}

  std::vector<EndpointPort> ports() const override { return feed_.ports(); }

  void send(const Step& step) override {
    now_ = step.interval().end;
    feed_.take(step, now_);
    channel_.poll(now_);
    warn(step.signal_input(0));
    warn_of_silence();
    if (const auto cut = channel_.first_cut(); cut && !cut_warned_) {
      cut_warned_ = true;
      log::warning("node '{}': {}", name_, command::cut_warning(*cut, settings_));
    }
  }

  void on_latency(command::TakeLatency take) override { feed_.on_latency(std::move(take)); }

  void stop(StopReason reason) override { channel_.stop(reason, now_); }

  std::vector<Counter> counters() const override { return channel_.counters(); }

  nlohmann::json summary() const override { return feed_.summary(); }

 private:
  /// Of a value that stops the robot, once a simulated second at most.
  void warn(const SignalInput& in) {
    const bool bad = in.valid() && !std::ranges::all_of(in.values, [](double value) {
                       return std::isfinite(value);
                     });
    if (bad && !bad_ && (!warned_at_ || now_ - *warned_at_ >= kNsPerSecond)) {
      warned_at_ = now_;
      log::warning("node '{}': the robot is stopped at {}: a value from '{}' is no finite number",
                   name_, format_time(now_), from_);
    }
    bad_ = bad;
  }

  void warn_of_silence() {
    const auto reason = channel_.stopped_by();
    const bool silence = reason == StopReason::sensor_silent || reason == StopReason::spikes_silent;
    if (silence && !silent_ && (!warned_at_ || now_ - *warned_at_ >= kNsPerSecond)) {
      warned_at_ = now_;
      log::warning("node '{}': the robot is stopped at {}: {}", name_, format_time(now_),
                   command::stop_cause(*reason, settings_, feed_));
    }
    silent_ = silence;
  }

  void publish(std::span<const double> values) {
    fields_.clear();
    if (all_channels_) {
      fields_.push_back({values, {}});
    } else {
      for (std::size_t i = 0; i < values.size(); ++i) {
        fields_.push_back({values.subspan(i, 1), {}});
      }
    }
    writer_.write(fields_, bytes_);
    if (keep_) {
      keep_(now_, bytes_);
    }
    topics_.publish(topic_, bytes_, now_);
  }

  MemoryTopics& topics_;
  std::string name_;
  std::string from_;
  bool bad_ = false;
  bool silent_ = false;
  bool cut_warned_ = false;
  std::optional<TimeNs> warned_at_;
  std::string topic_;
  bool all_channels_;
  messages::MessageWriter writer_;
  std::vector<messages::FieldValue> fields_;
  std::vector<std::byte> bytes_;
  TimeNs now_ = 0;
  command::CommandSettings settings_;
  command::CommandChannel channel_;
  command::CommandFeed feed_;
  Keep keep_;
};

}  // namespace

std::unique_ptr<Source> make_memory_sensor(MemoryTopics& topics, const SensorSpec& spec) {
  if (spec.part.kind == experiment::kRosEventSensor) {
    return std::make_unique<MemoryEventSensor>(topics, spec);
  }
  return std::make_unique<MemorySensor>(topics, spec);
}

std::unique_ptr<CommandEnd> make_memory_command(MemoryTopics& topics, const CommandSpec& spec) {
  return std::make_unique<MemoryCommand>(topics, spec);
}

}  // namespace spikeloop::fused
