// spikeloop-fused: the nodes of an experiment that share a process. It is a section of the job that
// `spikeloop run` makes of the experiment, and has the name of its process. A job with a single
// process runs without MUSIC (--alone): MPI takes a third of a second to start.
#include <algorithm>
#include <cstdlib>
#include <utility>

#include "music_processes.hpp"
#include "ros_transport.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/fused/robot_sensors.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/live/feed.hpp"
#include "spikeloop/process/music_main.hpp"
#include "spikeloop/status/deadline.hpp"
#include "spikeloop/status/signals.hpp"

namespace {

using namespace spikeloop;
using experiment::Sync;

std::vector<ParameterDescription> own_parameters() {
  const auto text = [](const char* name, std::optional<std::string> value, const char* line) {
    return ParameterDescription{
        .name = name, .type = ParameterType::text, .default_value = std::move(value), .text = line};
  };
  return {text("experiment", std::nullopt, "Experiment file"),
          text("settings", "[]", "Values in place of the experiment's, JSON"),
          text("ros", "none", "Key ros of the experiment, for spikeloop run"),
          text("ros_arguments", "", "NAME:=VALUE ... for the ROS node"),
          {.name = "stall_timeout",
           .unit = "s",
           .default_value = "60",
           .minimum = 0,
           .text = "Longest wall time until a stepped robot answers; 0: no limit"},
          {.name = "start_timeout",
           .unit = "s",
           .default_value = "60",
           .minimum = 0,
           .text = "Longest wall time until /clock brings a time"},
          text("about", "", "Additional content of resolved.json, JSON"),
          text("origin", "", "File whose directory relative paths start in"),
          text("replay_bag", "", "Replay: bag that replaces the robot"),
          text("changes", "", "Changes of parameters in the run that is repeated")};
}

music::ProgramText program_text() {
  music::ProgramText text;
  text.name = "spikeloop-fused";
  text.summary = "Runs those nodes of an experiment that share a process";
  text.ports = "  those of the connections to the other processes\n";
  text.parameters = own_parameters();
  text.may_run_alone = true;
  text.example = "  spikeloop run FILE.yaml  writes its section\n";
  return text;
}

experiment::Overrides overrides_of(const Parameters& keys) {
  experiment::Overrides overrides;
  overrides.settings = settings_from_text(keys.text("settings"));
  overrides.try_nodes = false;  // the launcher has, and the graph makes them at once
  overrides.origin = keys.text("origin");
  overrides.changes = keys.text("changes");
  if (keys.given("replay_bag")) {
    overrides.replay = {keys.text("replay_bag")};
  }
  return overrides;
}

fused::RunOptions options_of(const Parameters& keys, const music::Process& process) {
  const char* const folder = std::getenv("SPIKELOOP_OUT");
  return {.folder = folder == nullptr ? "" : folder,
          .record = process.common().record,
          .process = process.label(),
          .about = nlohmann::json::parse(keys.text("about"), nullptr, false),
          .live_folder = live::folder_from_environment()};
}

/// The one that writes down the robot's path.
std::string first_at_robot(const experiment::Experiment& experiment) {
  return std::ranges::find_if(
             experiment.layout.processes,
             [&](const auto& process) { return meets_robot(experiment, process.name); })
      ->name;
}

/// The watch of a command over ROS takes the signals of its process.
bool watches(const experiment::Experiment& experiment, const std::string& process) {
  return experiment.ros != experiment::Ros::none &&
         std::ranges::any_of(experiment.nodes, [&](const experiment::Node& node) {
           return node.kind == experiment::kRosCommand &&
                  process_of(experiment, node.name) == process;
         });
}

int report(const fused::RunResult& result, music::Process& process, MusicProcesses& others) {
  if (result.exit_code != 0) {  // before the report, so that the report is not that of an early end
    music::end_job(process.label(), result.exit_code, result.reason);
  }
  others.finish(result.summary);
  return result.exit_code;
}

int run_experiment(const experiment::Experiment& experiment, music::Process& process,
                   const Parameters& keys, MusicProcesses& others) {
  const auto stop = [] { return status::stop_requested(); };
  const auto enter = [&](bool waits) {
    process.enter(waits ? status::Phase::waiting : status::Phase::computing);
  };
  bool begun = false;
  const fused::RunEvents events{
      .progress = [&](const fused::Progress& progress) { others.take(progress); },
      .stop = stop,
      .waits =
          [&](bool waits) {
            if (!std::exchange(begun, true)) {
              process.say_begun();  // a pause before the first tick may take any time
            }
            enter(waits);
          }};
  const fused::RunOptions options = options_of(keys, process);
  if (experiment.ros == experiment::Ros::none || !meets_robot(experiment, process.label())) {
    return report(fused::run(experiment, options, events, &others), process, others);
  }
  const bool first = first_at_robot(experiment) == process.label();
  RosTransport transport(experiment, process.label(), keys.text("ros_arguments"),
                         first ? options.folder : "", *options.failures,
                         {stop, enter, from_seconds(keys.number("stall_timeout")),
                          from_seconds(keys.number("start_timeout"))});
  if (experiment.sync == Sync::sim_time || experiment.sync == Sync::lockstep) {
    process.say_begun();  // it waits for the robot as long as that takes
  }
  return transport.rosout().during([&] {
    fused::Run run(experiment, transport, options, events, &others);
    while (run.tick()) {
    }
    const fused::RunResult result = run.finish();
    if (result.exit_code != 0) {
      transport.rosout().error(result.reason);
    }
    // Report before the ROS session closes: closing may hang.
    return status::end_in_time(report(result, process, others));
  });
}

int run(music::Process& process) {
  const Parameters keys = process.read(own_parameters());
  if (process.checking()) {
    return 0;  // whoever wrote the section has checked the experiment
  }
  const auto loaded =
      experiment::load(keys.text("experiment"), overrides_of(keys), fused::look_at_robot);
  if (!loaded->diagnostics.empty()) {
    throw ConfigurationError(loaded->diagnostics.front().text());
  }
  const auto experiment = experiment::with_layout_delays(*loaded->experiment);
  if (!watches(experiment, process.label())) {
    command::Watch::release_signals();
  }
  MusicProcesses others(process, experiment);
  return run_experiment(experiment, process, keys, others);
}

}  // namespace

int main(int argc, char** argv) {
  command::Watch::block_signals();  // before MPI and roscpp start threads
  return music::music_main(argc, argv, program_text(), run);
}
