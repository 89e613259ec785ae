#include "ros1_transport.hpp"

#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/command/mapping.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/ros1/sensor.hpp"
#include "spikeloop/ros1_command/ros1_command.hpp"

namespace spikeloop {
namespace {

class RosCommandEnd : public fused::CommandEnd {
 public:
  RosCommandEnd(ros1::Session& session, const ros1_command::Address& address,
                const command::CommandSettings& settings, fused::Keep keep)
      : keep_(std::move(keep)), command_(session, address, settings, sent()) {}
  std::vector<EndpointPort> ports() const override { return command_.ports(); }
  void send(const Step& step) override {
    command_.send(step);
    now_ = step.interval().end;
    keep_sent();
  }
  std::vector<Counter> counters() const override { return command_.counters(); }
  void stop(command::StopReason reason) override {
    command_.stop(reason);
    keep_sent();
  }
  nlohmann::json summary() const override { return command_.summary(); }

 private:
  /// Commands leave in the thread that stops the robot, too, which must never wait for a disk.
  ros1_command::Ros1Command::Sent sent() {
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
  ros1_command::Ros1Command command_;  // last: it may still send while it ends
};

}  // namespace

Ros1Transport::Ros1Transport(const experiment::Experiment& experiment)
    : experiment_(experiment),
      session_({.node_name = "spikeloop_" + experiment.name, .unique_name = true}) {}

std::unique_ptr<Source> Ros1Transport::sensor(const fused::SensorSpec& spec) {
  const experiment::Part& part = spec.part;
  return std::make_unique<ros1::Sensor>(
      session_, ros1::SensorSettings{.topic = part.parameters.text("topic"),
                                     .message_type = part.parameters.text("message"),
                                     .fields = experiment::sensor_fields(part.parameters),
                                     .width = spec.width,
                                     .strict = true,
                                     .initial = experiment::sensor_initial(part.parameters),
                                     .keep = spec.keep});
}

std::unique_ptr<fused::CommandEnd> Ros1Transport::command(const fused::CommandSpec& spec) {
  const Parameters& keys = spec.part.parameters;
  return std::make_unique<RosCommandEnd>(
      session_,
      ros1_command::Address{spec.part.name, keys.text("topic"), spec.part.mapping.message_type,
                            command::field_paths(spec.part.mapping)},
      command::command_settings(keys, spec.map, keys.number("command_rate"),
                                {experiment_.tick, experiment_.real_time_factor}, spec.with_pace),
      spec.keep);
}

}  // namespace spikeloop
