#include "ros_transport.hpp"

#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "clock_pacer.hpp"
#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/command/mapping.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/session/open.hpp"
#include "spikeloop/topics/arguments.hpp"
#include "spikeloop/topics/event_sensor.hpp"
#include "spikeloop/topics/sensor.hpp"

namespace spikeloop {
namespace {

using experiment::Sync;

bool in_simulated_time(Sync sync) {
  return sync == Sync::lockstep || sync == Sync::sim_time;
}

class RosCommandEnd : public fused::CommandEnd {
 public:
  RosCommandEnd(topics::Session& session, const ros_command::Address& address,
                const command::CommandSettings& settings, fused::Keep keep)
      : keep_(std::move(keep)), command_(session, address, settings, sent()) {}
  std::vector<EndpointPort> ports() const override { return command_.ports(); }
  void send(const Step& step) override {
    command_.send(step);
    now_ = step.interval().end;
    keep_sent();
  }
  std::vector<Counter> counters() const override { return command_.counters(); }
  void on_latency(command::TakeLatency take) override { command_.on_latency(std::move(take)); }
  void stop(command::StopReason reason) override {
    command_.stop(reason);
    keep_sent();
  }
  nlohmann::json summary() const override { return command_.summary(); }
  ros_command::RosCommand& ros() { return command_; }

 private:
  /// Commands leave in the thread that stops the robot, too, which must never wait for a disk.
  ros_command::RosCommand::Sent sent() {
    if (!keep_) {
      return {};
    }
    return [this](std::span<const std::byte> message) {
      const std::lock_guard lock(mutex_);
      sent_.emplace_back(message.begin(), message.end());
    };
  }
  void keep_sent() {
    std::vector<std::vector<std::byte>> messages;
    {
      const std::lock_guard lock(mutex_);
      messages.swap(sent_);
    }
    for (const auto& message : messages) {
      keep_(now_, message);
    }
  }

  fused::Keep keep_;
  TimeNs now_ = 0;
  std::mutex mutex_;
  std::vector<std::vector<std::byte>> sent_;
  ros_command::RosCommand command_;  // last: it may still send while it ends
};

}  // namespace

RosTransport::RosTransport(const experiment::Experiment& experiment,
                           const std::string& ros_arguments, const std::string& folder,
                           const LoopSurroundings& surroundings)
    : experiment_(experiment),
      session_(session::open({{.node_name = "spikeloop_" + experiment.name,
                               .unique_name = true,
                               .arguments = topics::read_ros_arguments(ros_arguments)},
                              experiment::dialect_of(experiment.ros)})),
      waiting_(surroundings) {
  if (experiment.sync == Sync::lockstep) {
    robot_.emplace(*session_, experiment.tick, waiting_);
  } else if (!experiment.robot && !folder.empty()) {
    odometry_.emplace(*session_, folder);  // ours writes its path itself
  }
}

std::unique_ptr<Source> RosTransport::sensor(const fused::SensorSpec& spec) {
  return spec.part.kind == experiment::kRosEventSensor ? event_sensor(spec) : signal_sensor(spec);
}

/// A robot that is stepped says how many messages it has sent, and all of them count.
template <typename Sensor>
void RosTransport::add_to_robot(const std::string& topic, const Sensor& sensor) {
  if (robot_) {
    robot_->add_sensor({session_->whole_topic(topic), [&sensor] { return sensor.has_publishers(); },
                        [&sensor] { return sensor.received(); },
                        [&sensor] { sensor.require_sound(); }});
  }
}

template <typename Settings>
void RosTransport::add_surroundings(const fused::SensorSpec& spec, Settings& settings) {
  settings.keep = spec.keep;
  settings.simulated_pace = in_simulated_time(experiment_.sync);
  if (robot_) {
    settings.queue = 0;
    settings.arrived = [this] { waiting_.notify(); };
  }
}

std::unique_ptr<Source> RosTransport::event_sensor(const fused::SensorSpec& spec) {
  const Parameters& keys = spec.part.parameters;
  topics::EventSensorSettings settings{.topic = keys.text("topic"),
                                       .events = experiment::event_settings(keys),
                                       .latency = from_seconds(keys.number("latency")),
                                       .from_begin = robot_.has_value()};
  settings.events.width = spec.width;
  add_surroundings(spec, settings);
  auto sensor = std::make_unique<topics::EventSensor>(*session_, settings);
  add_to_robot(settings.topic, *sensor);
  return sensor;
}

std::unique_ptr<Source> RosTransport::signal_sensor(const fused::SensorSpec& spec) {
  const experiment::Part& part = spec.part;
  topics::SensorSettings settings{.topic = part.parameters.text("topic"),
                                  .message_type = part.parameters.text("message"),
                                  .rule = experiment::sensor_rule(part.parameters),
                                  .width = spec.width,
                                  .strict = true,
                                  .initial = experiment::sensor_initial(part.parameters)};
  add_surroundings(spec, settings);
  auto sensor = std::make_unique<topics::Sensor>(*session_, settings);
  add_to_robot(settings.topic, *sensor);
  return sensor;
}

command::CommandSettings RosTransport::command_settings(const fused::CommandSpec& spec) const {
  const Parameters& keys = spec.part.parameters;
  const auto clock = robot_ ? command::CommandClock::lockstep : command::CommandClock::simulated;
  command::CommandSettings settings =
      in_simulated_time(experiment_.sync)
          ? command::simulated_settings(keys, spec.map, clock, spec.with_pace)
          : command::command_settings(keys, spec.map, keys.number("command_rate"),
                                      {experiment_.tick, experiment_.real_time_factor},
                                      spec.with_pace);
  fused::add_safety(spec, settings);
  return settings;
}

std::unique_ptr<fused::CommandEnd> RosTransport::command(const fused::CommandSpec& spec) {
  const ros_command::Address address{spec.part.name, spec.part.parameters.text("topic"),
                                     spec.part.mapping.message_type,
                                     command::field_paths(spec.part.mapping)};
  auto end = std::make_unique<RosCommandEnd>(*session_, address, command_settings(spec), spec.keep);
  commands_.push_back(&end->ros());
  if (robot_) {
    robot_->add_command({session_->whole_topic(address.topic),
                         [&ros = end->ros()] { return ros.has_subscribers(); },
                         [&ros = end->ros()] { return ros.sent(); },
                         {}});
  }
  return end;
}

std::unique_ptr<Pacer> RosTransport::clock() {
  return make_clock_pacer(*session_, experiment_.tick, waiting_, [this] {
    for (ros_command::RosCommand* command : commands_) {
      command->alive();
    }
  });
}

void RosTransport::begin(TimeNs time) {
  if (robot_ && time == 0) {
    robot_->begin();
  }
}

void RosTransport::end(TimeNs time) {
  if (robot_) {
    robot_->advance(time);
  }
  if (odometry_) {
    odometry_->tick(time);
  }
}

void RosTransport::finish() {
  if (robot_) {
    robot_->end();
  }
  if (odometry_) {
    odometry_->close();
  }
}

nlohmann::json RosTransport::summary() const {
  return odometry_ ? odometry_->summary() : nlohmann::json::object();
}

}  // namespace spikeloop
