// spikeloop-fused-music: the nodes of an experiment that has simulators beside them, in one
// process, a section of the job that `spikeloop run` makes of the experiment.
#include <cstdlib>

#include "music_simulators.hpp"
#include "ros_transport.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/fused/robot_sensors.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/process/music_main.hpp"
#include "spikeloop/status/signals.hpp"

namespace {

using namespace spikeloop;
using experiment::Sync;

std::vector<ParameterDescription> own_parameters() {
  const auto text = [](const char* name, std::optional<std::string> value, const char* line) {
    return ParameterDescription{
        .name = name, .type = ParameterType::text, .default_value = std::move(value), .text = line};
  };
  return {text("experiment", std::nullopt, "the experiment file"),
          text("wait_for", "realtime", "the experiment's sync"),
          {.name = "ros",
           .type = ParameterType::choice,
           .default_value = "none",
           .choices = {"none", "1", "2"},
           .text = "the experiment's ros"},
          text("ros_arguments", "", "NAME:=VALUE ... for the node of ROS"),
          {.name = "stall_timeout",
           .unit = "s",
           .default_value = "60",
           .minimum = 0,
           .text = "longest wall time that a stepped robot may take to answer; 0: any"},
          text("about", "", "what resolved.json says beside the experiment, JSON"),
          text("replay_origin", "", "of a replay: the file that was run"),
          text("replay_bag", "", "of a replay: the messages in the robot's place")};
}

music::ProgramText program_text() {
  music::ProgramText text;
  text.name = "spikeloop-fused-music";
  text.summary = "The nodes of an experiment in one process, beside simulators";
  text.ports = "  as the experiment's connections with its simulators\n";
  text.parameters = own_parameters();
  text.example = "  spikeloop run FILE.yaml  writes its section\n";
  return text;
}

experiment::Overrides overrides_of(const Parameters& keys, const music::CommonKeys& common) {
  experiment::Overrides overrides;
  if (common.stoptime) {
    overrides.duration_s = to_seconds(*common.stoptime);
  }
  overrides.seed = common.seed;
  overrides.real_time_factor = common.rtf;
  overrides.sync = experiment::sync_named(keys.text("wait_for"));
  overrides.ros = experiment::ros_named(keys.text("ros"));
  overrides.try_nodes = false;  // the launcher has, and the graph makes them at once
  if (!keys.text("replay_origin").empty()) {
    overrides.replay = {keys.text("replay_origin"), keys.text("replay_bag")};
  }
  return overrides;
}

bool over_ros(const Parameters& keys) {
  return keys.text("ros") != "none";
}

fused::RunOptions options_of(const Parameters& keys, const music::CommonKeys& common) {
  const char* const folder = std::getenv("SPIKELOOP_OUT");
  return {.folder = folder == nullptr ? "" : folder,
          .record = common.record,
          .about = nlohmann::json::parse(keys.text("about"), nullptr, false)};
}

fused::RunResult run_experiment(const experiment::Experiment& experiment, music::Process& process,
                                const Parameters& keys, MusicSimulators& simulators) {
  const auto stop = [] { return status::stop_requested(); };
  const fused::RunEvents events{
      .progress = [&](const fused::Progress& progress) { simulators.take(progress); },
      .stop = stop};
  const fused::RunOptions options = options_of(keys, process.common());
  if (!over_ros(keys)) {
    return fused::run(experiment, options, events, &simulators);
  }
  const auto enter = [&](bool waits) {
    process.enter(waits ? status::Phase::waiting : status::Phase::computing);
  };
  RosTransport transport(experiment, keys.text("ros_arguments"), options.folder,
                         {stop, enter, from_seconds(keys.number("stall_timeout"))});
  if (experiment.sync == Sync::sim_time || experiment.sync == Sync::lockstep) {
    process.say_begun();  // it waits for the robot as long as that takes
  }
  return fused::run(experiment, transport, options, events, &simulators);
}

int run(music::Process& process) {
  const Parameters keys = process.read(own_parameters());
  const music::CommonKeys& common = process.common();
  if (process.checking()) {
    return 0;  // whoever wrote the section has checked the experiment
  }
  if (!over_ros(keys)) {
    command::Watch::release_signals();
  }
  const auto loaded =
      experiment::load(keys.text("experiment"), overrides_of(keys, common), fused::look_at_robot);
  if (!loaded->faults.empty()) {
    throw ConfigurationError(loaded->faults.front().text);
  }
  const auto experiment = experiment::with_fused_delays(*loaded->experiment);
  MusicSimulators simulators(process);
  const fused::RunResult result = run_experiment(experiment, process, keys, simulators);
  if (result.exit_code != 0) {
    return music::end_job(process.label(), result.exit_code, result.reason);
  }
  simulators.finish(result.summary);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  command::Watch::block_signals();  // before MPI and roscpp start threads
  return music::music_main(argc, argv, program_text(), run);
}
