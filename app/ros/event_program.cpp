// ros_event_sensor_adapter: an event camera as spikes.
#include <fmt/format.h>

#include "programs.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/status/deadline.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/topics/event_sensor.hpp"
#include "spikeloop/topics/rosout.hpp"

namespace spikeloop {
namespace {

std::vector<ParameterDescription> event_parameters(const RosProgram& program) {
  return program_parameters(program, {update_rate_parameter()});
}

}  // namespace

music::ProgramText event_text(const RosProgram& program) {
  music::ProgramText text;
  text.name = program.name;
  text.summary = "Converts the events of an event camera to spikes, each at its own time";
  text.ports = "  out        output  spikes      One channel per pixel or block of pixels\n";
  text.parameters = event_parameters(program);
  text.example = fmt::format(
      "  stoptime=10\n  [event]\n  binary={}\n  np=1\n  ros_topic=/dvs/events\n"
      "  roi=100,60,128,128\n  downsample=4\n  polarity=split\n"
      "  event.out -> RECEIVER.in [2048]\n",
      program.name);
  text.notes =
      "Pixel (x, y) is channel y * W + x. W is the width of the camera, or of the roi, divided by\n"
      "downsample and rounded up; with the height H the port has W * H channels. polarity=split:\n"
      "brighter (on) as above, darker (off) on channel W * H + y * W + x; 2 * W * H channels.\n\n"
      "The newest event of the first message is assumed to have happened when the message\n"
      "arrived. Every event is sent `latency` after it happened, with the spacing of the stamps.\n"
      "Later events are sent at once and counted (late_events). If the camera's clock jumps back,\n"
      "as in a bag that starts again, or ahead by more than 1 s, the next message counts as the\n"
      "first one (clock_jumps). Messages from before the start of the run are left out.\n\n"
      "There is no port data_stamp, because a camera sends nothing while nothing changes. So a\n"
      "command adapter does not know the age of its data, and max_age has no effect.\n";
  text.defaults.clock_master = true;
  return text;
}

int run_events(music::Process& process, const RosProgram& program) {
  command::Watch::release_signals();
  process.set_defaults({.clock_master = true, .accept_one_tick = false});
  process.declare_ports({"out"});
  Section section = read_section(process, program, event_parameters(program));
  experiment::read_endpoint(section.node, process.file_directory(), section.ros.ros);
  topics::EventSensorSettings settings = experiment::event_sensor_settings(section.node.parameters);
  settings.events.width = process.width("out");
  settings.events.where = process.where("out");

  const auto out = process.spike_output("out");
  if (process.checking()) {
    topics::EventSensor::check(section.ros.ros, settings);
    process.check();
    return 0;
  }
  const auto session = session::open(section.ros);
  const status::TerminationHook on_termination([&] { session->leave(); });  // the last of all
  topics::Rosout rosout(*session);
  topics::EventSensor sensor(*session, settings);
  return status::end_in_time(
      rosout.during([&] { return run_topic(process, section, sensor, *out); }));
}

}  // namespace spikeloop
