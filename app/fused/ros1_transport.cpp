#include "ros1_transport.hpp"

#include <nlohmann/json.hpp>

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
                const command::CommandSettings& settings)
      : command_(session, address, settings) {}
  std::vector<EndpointPort> ports() const override { return command_.ports(); }
  void send(const Step& step) override { command_.send(step); }
  std::vector<Counter> counters() const override { return command_.counters(); }
  void on_latency(command::TakeLatency take) override { command_.on_latency(std::move(take)); }
  void stop(command::StopReason reason) override { command_.stop(reason); }
  nlohmann::json summary() const override { return command_.summary(); }

 private:
  ros1_command::Ros1Command command_;
};

}  // namespace

Ros1Transport::Ros1Transport(const experiment::Experiment& experiment)
    : experiment_(experiment),
      session_({.node_name = "spikeloop_" + experiment.name, .unique_name = true}) {}

std::unique_ptr<Source> Ros1Transport::sensor(const experiment::Part& part, std::uint32_t width) {
  return std::make_unique<ros1::Sensor>(
      session_, ros1::SensorSettings{.topic = part.parameters.text("topic"),
                                     .message_type = part.parameters.text("message"),
                                     .fields = experiment::sensor_fields(part.parameters),
                                     .width = width,
                                     .strict = true,
                                     .initial = experiment::sensor_initial(part.parameters)});
}

std::unique_ptr<fused::CommandEnd> Ros1Transport::command(const fused::CommandSpec& spec) {
  const Parameters& keys = spec.part.parameters;
  return std::make_unique<RosCommandEnd>(
      session_,
      ros1_command::Address{spec.part.name, keys.text("topic"), spec.part.mapping.message_type,
                            command::field_paths(spec.part.mapping)},
      command::command_settings(keys, spec.map, keys.number("command_rate"),
                                {experiment_.tick, experiment_.real_time_factor}, spec.with_pace));
}

}  // namespace spikeloop
