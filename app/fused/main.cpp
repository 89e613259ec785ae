// spikeloop-fused: an experiment over ROS in one process, which `spikeloop run` starts and
// supervises.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "ros_transport.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/fused/robot_sensors.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/status/heartbeat.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/status/status.hpp"

namespace {

using namespace spikeloop;

constexpr const char* kLabel = "experiment";  // of the section that the launcher has for us

struct Arguments {
  std::string file;
  fused::RunOptions run;
  experiment::Overrides overrides;
  std::string sync;
  std::string ros;
  std::string ros_arguments;
  double stall_timeout_s = 60;
  std::string about;
  bool no_record = false;
};

int run(const Arguments& arguments, const status::Sender& sender) {
  const auto loaded = experiment::load(arguments.file, arguments.overrides, fused::look_at_robot);
  if (!loaded->diagnostics.empty()) {
    throw ConfigurationError(loaded->diagnostics.front().text());
  }
  const experiment::Experiment& experiment = *loaded->experiment;
  status::Heartbeat heartbeat(sender);
  const auto stop = [] { return status::stop_requested(); };
  const auto enter = [&](bool waits) {
    heartbeat.enter(waits ? status::Phase::waiting : status::Phase::computing);
  };
  RosTransport transport(experiment, arguments.ros_arguments, arguments.run.folder,
                         {stop, enter, from_seconds(arguments.stall_timeout_s)});
  sender.started();
  heartbeat.enter(status::Phase::computing);
  bool first = true;
  if (experiment.sync == experiment::Sync::sim_time ||
      experiment.sync == experiment::Sync::lockstep) {
    sender.first_tick();  // the loop has begun, and waits for the robot as long as that takes
    first = false;
  }
  TimeNs simulated = 0;
  const fused::RunEvents events{.ticked =
                                    [&](TimeNs time) {
                                      simulated = time;
                                      heartbeat.at(time);
                                      if (first) {
                                        sender.first_tick();
                                        first = false;
                                      }
                                    },
                                .progress =
                                    [&](const fused::Progress& progress) {
                                      sender.progress(progress.simulated, progress.wall,
                                                      progress.overruns);
                                    },
                                .stop = stop};
  const fused::RunResult result = fused::run(experiment, transport, arguments.run, events);
  heartbeat.enter(status::Phase::finalizing);
  if (result.exit_code != 0) {  // before the report, which else would be that of an early end
    fmt::print(stderr, "{}\n", result.reason);
    sender.failure(result.exit_code, result.reason);
  }
  auto summary = result.summary;
  if (summary.contains("counters")) {  // also of a run that has failed: how far it came
    const auto counters = summary["counters"];
    summary.erase("counters");
    sender.report(counters, summary, simulated);
  }
  return result.exit_code;
}

int guarded(const Arguments& arguments) {
  const status::Sender sender(kLabel);
  try {
    return run(arguments, sender);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    sender.failure(error.exit_code(), error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    sender.failure(1, error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  command::Watch::block_signals();
  const status::SignalThread signals;
  log::set_sink([](log::Level level, std::string_view message) {
    fmt::print(stderr, "{}{}\n", level == log::Level::warning ? "warning: " : "", message);
  });
  CLI::App app("Runs an experiment over ROS in one process; started by  spikeloop run FILE.yaml",
               "spikeloop-fused");
  Arguments arguments;
  arguments.overrides.try_nodes = false;  // the launcher has, and the graph makes them at once
  app.add_option("FILE", arguments.file, "Experiment file")->required();
  app.add_option("--out", arguments.run.folder, "Run folder; must exist");
  app.add_option("--duration", arguments.overrides.duration_s, "Simulated time, s");
  app.add_option("--seed", arguments.overrides.seed, "Seed of the random numbers");
  app.add_option("--real-time-factor", arguments.overrides.real_time_factor,
                 "Simulated time / wall time");
  app.add_option("--sync", arguments.sync, "Replaces the key sync");
  app.add_option("--ros", arguments.ros, "Replaces the key ros");
  app.add_option("--ros-arguments", arguments.ros_arguments, "NAME:=VALUE ... for the ROS node");
  app.add_option("--stall-timeout", arguments.stall_timeout_s,
                 "Longest wall time until a stepped robot answers, s; 0: no limit");
  app.add_option("--about", arguments.about, "Additional content of resolved.json, JSON");
  app.add_flag("--no-record", arguments.no_record, "Do not record the outputs of nodes");
  CLI11_PARSE(app, argc, argv);
  arguments.run.record = !arguments.no_record;
  arguments.run.about = nlohmann::json::parse(arguments.about, nullptr, false);
  if (!arguments.sync.empty()) {
    arguments.overrides.sync = experiment::sync_named(arguments.sync);
  }
  if (!arguments.ros.empty()) {
    arguments.overrides.ros = experiment::ros_named(arguments.ros);
  }
  return guarded(arguments);
}
