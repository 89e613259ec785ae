// ros_event_sensor_adapter: an event camera as spikes.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "programs.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/sensing/event_keys.hpp"
#include "spikeloop/topics/event_sensor.hpp"

namespace spikeloop {
namespace {

std::vector<ParameterDescription> program_parameters(const RosProgram& program) {
  auto parameters = connection_parameters(program);
  parameters.push_back(
      {.name = "message_type",
       .type = ParameterType::text,
       .default_value = "dvs_msgs/EventArray",
       .text = "That, or event_camera_msgs/EventPacket, encoded as evt3, evt2 or mono"});
  std::ranges::move(sensing::event_parameters(), std::back_inserter(parameters));
  parameters.push_back({.name = "sensor_update_rate",
                        .unit = "Hz",
                        .default_value = "30",
                        .minimum = 0,
                        .text = "Accepted for older files; messages are taken when they arrive"});
  return parameters;
}

messages::EventSettings event_settings(const music::Process& process,
                                       const Parameters& parameters) {
  const std::string& type = parameters.text("message_type");
  located_at(parameters.where("message_type"), [&] { messages::check_event_type(type); });
  messages::EventSettings settings = sensing::event_settings(parameters, type);
  settings.width = process.width("out");
  settings.where = process.where("out");
  return settings;
}

}  // namespace

music::ProgramText event_text(const RosProgram& program) {
  music::ProgramText text;
  text.name = program.name;
  text.summary = "The events of a camera as spikes, each at its own time";
  text.ports = "  out        output  spikes      a channel a pixel, or a block of pixels\n";
  text.parameters = program_parameters(program);
  text.example = fmt::format(
      "  stoptime=10\n  [event]\n  binary={}\n  np=1\n  ros_topic=/dvs/events\n"
      "  roi=100,60,128,128\n  downsample=4\n  polarity=split\n"
      "  event.out -> RECEIVER.in [2048]\n",
      program.name);
  text.notes =
      "Pixel (x, y) is channel y * W + x, where W is the width of the camera, or of the roi, over\n"
      "downsample, rounded up; with H for the height the port has W * H channels. polarity=split:\n"
      "brighter (on) as before, darker (off) on channel W * H + y * W + x; 2 * W * H channels.\n\n"
      "The newest event of the first message is taken to have happened when the message came. All\n"
      "events are sent `latency` after they happened, with the spacing of their stamps; what "
      "comes\n"
      "too late for that is sent at once, and counted (late_events). When the camera's clock "
      "jumps\n"
      "back, as that of a bag that begins again, or by more than 1 s ahead, the next message is a\n"
      "first one again (clock_jumps). Nothing is sent of messages from before the run began.\n\n"
      "There is no port pace: a camera that sees nothing new sends nothing, so a command adapter\n"
      "cannot tell how old its commands' data are, and max_age does nothing.\n";
  text.defaults.pace = true;
  return text;
}

int run_events(music::Process& process, const RosProgram& program) {
  command::Watch::release_signals();
  process.set_defaults({.pace = true, .accept_one_tick = false});
  process.declare_ports({"out"});
  const Parameters parameters = process.read(program_parameters(program));
  topics::EventSensorSettings settings;
  settings.topic = required_topic(process, parameters, "/dvs/events");
  settings.events = event_settings(process, parameters);
  settings.latency = from_seconds(parameters.number("latency"));

  const auto out = process.spike_output("out");
  const session::Settings node = session_settings(parameters);
  if (process.checking()) {
    topics::EventSensor::check(node.ros, settings);
    process.check();
    return 0;
  }
  const auto session = session::open(node);
  topics::EventSensor sensor(*session, settings);
  return run_topic(process, {settings.topic, node.ros}, sensor, *out);
}

}  // namespace spikeloop
