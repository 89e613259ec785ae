#include "commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "check_command.hpp"
#include "console.hpp"
#include "experiment_command.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "recorded_run.hpp"
#include "resources.hpp"
#include "ros2_look.hpp"
#include "ros_arguments.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/job.hpp"
#include "spikeloop/launch/run_folder.hpp"
#include "versions.hpp"

namespace spikeloop::app::run_command {
namespace {

struct RunArguments {
  topics::CommandLine line;
  std::string file;
  launch::JobOptions job;
  double start_timeout_s = 60;
  double stall_timeout_s = 60;
  std::string sync;
  std::string ros;
  std::string layout;
  std::vector<std::string> settings;
  robot::SpectatorWords spectators;
  LiveOptions live;
  bool force = false;
  bool no_record = false;
  bool no_data_stamp = false;
  bool quiet = false;
  bool verbose = false;
  bool dry_run = false;
  std::vector<CLI::Option*> timeouts;        ///< of runs in several processes
  std::vector<CLI::Option*> for_music;       ///< options that only .music files have
  std::vector<CLI::Option*> for_experiment;  ///< options that only experiments have
};

constexpr const char* kFooter = R"(Examples:
  spikeloop run braitenberg.yaml          runs an experiment; writes runs/braitenberg-1
  spikeloop run braitenberg.yaml --sync lockstep --duration 5min --seed 3 --out run1
  spikeloop run runs/braitenberg-1        repeats a run: its files, with its settings
  spikeloop run braitenberg.yaml --set encoder.rate_max="100 Hz" --set robot.seed=3
  spikeloop run braitenberg.yaml --render drive.mp4 --render-view above+chase
  spikeloop run braitenberg.yaml --live   shows the run in the browser; open the printed address
  spikeloop run explorer.yaml /scan:=/front/scan               remaps a topic, as in ROS 1
  spikeloop run explorer.yaml --ros-args -r /scan:=/front/scan -r __ns:=/arena       as in ROS 2
  spikeloop run braitenberg.music --roscore --robot --duration 60 --out run1
  spikeloop run loop.music --seed 7 --record --out run2
  spikeloop run loop.music --dry-run      prints file and command; starts nothing
  spikeloop run loop.music --hostfile hosts --out run3     all hosts must share the folders

The programs run in the directory of FILE. The keys in FILE are used, unless an option replaces
them. Ctrl-C, SIGUSR1, SIGTERM, SIGQUIT and SIGHUP end the loops of the programs. Programs that still
run after 5 s (2 s in a job with other programs) are ended. A second Ctrl-C kills them at once.

Exit codes:
  0  finished              2  the file or an option is invalid
  3  a program, the robot or the ROS master is missing, stalls or ends too early
  4  a file cannot be read or written                       5  a node failed
  7  messages arrived, and none of them was usable
  129, 130, 131, 138, 143  stopped by SIGHUP (a closed terminal), Ctrl-C, SIGQUIT, SIGUSR1, SIGTERM
  128 + N  a program was killed by signal N
  other    exit code of the first program that failed)";

/// An option whose text goes through `parse`, which throws.
template <typename Target, typename Parse>
CLI::Option* add_value(CLI::App& command, const char* name, Target& target, Parse parse,
                       const char* kind, const char* text) {
  return command
      .add_option_function<std::string>(
          name, [&target, parse](const std::string& value) { target = parse(value); }, text)
      ->type_name(kind);
}

void add_values(CLI::App& command, RunArguments& arguments) {
  auto& run = arguments.job.run;
  add_value(command, "--duration", run.duration_s, duration_s, "TIME",
            "Simulated time, in s or with a unit (5min); stoptime of every section");
  add_value(command, "--seed", run.seed, seed, "NUMBER", "Seed of all random numbers");
  add_value(command, "--real-time-factor", run.real_time_factor, real_time_factor, "NUMBER",
            "Ratio of simulated time to wall time, also of the robot");
  arguments.timeouts = {
      add_value(command, "--start-timeout", arguments.start_timeout_s, start_timeout_s, "TIME",
                "Longest time until every Spikeloop program has ticked")
          ->default_str("60"),
      add_value(command, "--stall-timeout", arguments.stall_timeout_s, stall_timeout_s, "TIME",
                "Longest time without a tick of a Spikeloop program or stepped robot; 0: no limit")
          ->default_str("60")};
}

void add_options(CLI::App& command, RunArguments& arguments) {
  auto& job = arguments.job;
  command
      .add_option("FILE", arguments.file,
                  "Experiment file (.yaml), MUSIC configuration file, or run folder to repeat")
      ->required();
  add_values(command, arguments);
  command
      .add_option("--ros", arguments.ros,
                  "ROS version; replaces the key ros of the experiment or of every section")
      ->check(CLI::IsMember({"1", "2"}));
  // For help and completion: main() takes it from the command line with all that follows.
  command.add_flag("--ros-args")
      ->description(
          "ROS arguments, up to the end or --: -r NAME:=VALUE remaps a topic, as does NAME:=VALUE "
          "without --ros-args");
  auto* out =
      command
          .add_option(
              "--out", job.folder,
              "Run folder for summary.json, recordings and logs [runs/NAME-N for experiments]")
          ->check(named("folder"));
  command.add_flag("--force", arguments.force, "Replace the results of a run in that folder")
      ->needs(out);
  command.add_flag("--record", job.run.record, "Record the outputs of all Spikeloop programs")
      ->needs(out);
  command.add_option("--hostfile", job.hostfile, "Open MPI hostfile of the job")
      ->check(named("hostfile"))
      ->needs(out);
  command.add_flag("--roscore", job.roscore,
                   "Start a ROS 1 master, at a free port, if none responds");
  auto* robot =
      command.add_flag("--robot", job.robot, "Start spikeloop-robot if /scan has no publisher");
  command
      .add_option("--robot-arg", job.robot_arguments,
                  "Argument for spikeloop-robot; repeatable: --robot-arg=--world=arena.xml")
      ->allow_extra_args(false)
      ->needs(robot);
  command.add_flag("--no-data-stamp", arguments.no_data_stamp,
                   "Do not add a data_stamp connection from sensor adapter to command adapter");
  command.add_flag("--dry-run", arguments.dry_run, "Print only effective file and command");
  auto* quiet = command.add_flag("-q,--quiet", arguments.quiet, "Print only warnings and errors");
  command.add_flag("-v,--verbose", arguments.verbose, "Also print the output of mpirun")
      ->excludes(quiet);
}

/// Who watches the robot.
void add_picture_options(CLI::App& command, robot::SpectatorWords& spectators) {
  auto* render = command.add_option(
      "--render", spectators.render,
      "Film of the robot, FILE.mp4 (.webm, .mkv, .gif; needs ffmpeg); folder of images; or "
      "FILE.png, the final state with the path");
  command
      .add_option("--render-view", spectators.view, "above, chase, camera, or several: above+chase")
      ->capture_default_str()
      ->needs(render);
  command.add_option("--render-size", spectators.size, "WIDTHxHEIGHT in pixels")
      ->capture_default_str()
      ->needs(render);
  command.add_option("--render-rate", spectators.rate_hz, "Images per simulated second")
      ->check(CLI::Range(0.001, 1000.0))
      ->capture_default_str()
      ->needs(render);
  command.add_flag("--view", spectators.window, "Show the robot in a window; needs a display");
}

void add_live_options(CLI::App& command, LiveOptions& live) {
  auto* on = command.add_flag("--live", live.on, "Show the run in the browser, and in Foxglove");
  add_address_options(command, live);
  for (const char* name : {"--live-port", "--live-host"}) {
    command.get_option(name)->needs(on);
  }
}

/// Those that only one kind of file has stand under a heading of their own.
void add_experiment_options(CLI::App& command, RunArguments& arguments) {
  command.add_option("--sync", arguments.sync, "Clock of the experiment; replaces the key sync")
      ->check(CLI::IsMember({"realtime", "unpaced", "lockstep", "sim_time"}));
  command
      .add_option("--layout", arguments.layout,
                  "fused: all nodes in one process; separate: one process per node, connected by "
                  "MUSIC; replaces the key layout")
      ->check(CLI::IsMember({"fused", "separate"}));
  add_settings(command, arguments.settings);
  command.add_flag("--no-record", arguments.no_record, "Do not record the outputs of nodes");
  add_picture_options(command, arguments.spectators);
  add_live_options(command, arguments.live);
  const auto group = [&command](std::vector<CLI::Option*>& list, const char* heading,
                                std::initializer_list<const char*> names) {
    for (const char* name : names) {
      list.push_back(command.get_option(name)->group(heading));
    }
  };
  group(arguments.for_experiment, "Experiment files",
        {"--set", "--layout", "--sync", "--no-record", "--render", "--render-view", "--render-size",
         "--render-rate", "--view", "--live", "--live-port", "--live-host"});
  group(arguments.for_music, ".music files",
        {"--record", "--hostfile", "--roscore", "--robot", "--robot-arg", "--no-data-stamp",
         "--dry-run"});
  arguments.for_music.push_back(
      command.add_flag("--no-pace", arguments.no_data_stamp, "Earlier name of --no-data-stamp")
          ->group(""));
}

void refuse_options(const std::vector<CLI::Option*>& options, const char* kind) {
  for (const CLI::Option* option : options) {
    if (option->count() > 0) {
      throw ConfigurationError(fmt::format("--{} is for {}; leave it out",
                                           option->get_lnames().front(), kind));  // hidden, too
    }
  }
}

Console::Volume volume_of(const RunArguments& arguments) {
  return arguments.quiet     ? Console::Volume::quiet
         : arguments.verbose ? Console::Volume::verbose
                             : Console::Volume::normal;
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000));
}

/// The options that stand for keys come last: they hold.
Settings settings_of(const RunArguments& arguments) {
  Settings settings = parse_settings(arguments.settings);
  const auto add = [&](const char* key, const std::string& value, const char* option) {
    if (!value.empty()) {
      settings.push_back({key, value, option});
    }
  };
  const auto& run = arguments.job.run;
  add("duration", run.duration_s ? fmt::format("{} s", *run.duration_s) : "", "--duration");
  add("seed", run.seed ? std::to_string(*run.seed) : "", "--seed");
  add("real_time_factor", run.real_time_factor ? fmt::format("{}", *run.real_time_factor) : "",
      "--real-time-factor");
  add("sync", arguments.sync, "--sync");
  add("ros", arguments.ros, "--ros");
  add("layout", arguments.layout, "--layout");
  return settings;
}

int run_file(const RunArguments& arguments) {
  refuse_options(arguments.for_music, ".music files, an experiment file says such things itself");
  ExperimentArguments experiment;
  experiment.file = arguments.file;
  experiment.folder = arguments.job.folder;
  experiment.force = arguments.force;
  experiment.record = !arguments.no_record;
  if (std::filesystem::is_directory(arguments.file)) {
    refuse_own_folder(arguments.job.folder, arguments.file);
    const RecordedRun run = read_run_again(arguments.file);
    for (const std::string& text : doubts(run)) {
      put(stderr, fmt::format("spikeloop: warning: {}\n", text));
    }
    experiment.file = run.experiment_file;
    experiment.overrides.origin = run.origin;
    experiment.overrides.settings = run.settings;
    experiment.overrides.changes = run.changes;
  }
  const Settings settings = settings_of(arguments);
  experiment.overrides.settings.insert(experiment.overrides.settings.end(), settings.begin(),
                                       settings.end());
  experiment.volume = volume_of(arguments);
  experiment.spectators = arguments.spectators;
  experiment.live = arguments.live;
  experiment.start_timeout = milliseconds(arguments.start_timeout_s);
  experiment.stall_timeout = milliseconds(arguments.stall_timeout_s);
  for (const CLI::Option* option : arguments.timeouts) {
    if (option->count() > 0) {
      experiment.timeout_given = option->get_name();
    }
  }
  experiment.line = arguments.line;
  return run_experiment(experiment);
}

int dry_run(const launch::Job& job, const Diagnostics& diagnostics, const std::string& path) {
  if (has_errors(diagnostics)) {
    return refuse(diagnostics, path);
  }
  std::string text;
  for (const Diagnostic& warning : diagnostics) {
    text += fmt::format("# warning: {}\n", warning.text());
  }
  put_result(text + fmt::format("# {}\n{}", job.command(), to_text(job.effective().file)));
  return 0;
}

int run(RunArguments& arguments) {
  if (is_experiment(arguments.file) || std::filesystem::is_directory(arguments.file)) {
    return run_file(arguments);
  }
  refuse_script(arguments.file);
  refuse_options(arguments.for_experiment, "experiment files");
  if (arguments.job.run.record && arguments.job.folder.empty()) {
    throw ConfigurationError(
        "--record: there is no folder to record to; give one with --out, as in --out run1");
  }
  arguments.job.run.data_stamp = !arguments.no_data_stamp;
  if (!arguments.ros.empty()) {
    arguments.job.run.ros = std::stoi(arguments.ros);
  }
  arguments.job.start_timeout = milliseconds(arguments.start_timeout_s);
  arguments.job.stall_timeout = milliseconds(arguments.stall_timeout_s);
  arguments.job.published_in_ros2 = published_in_ros2;
  const MusicFile file = read_music_file(arguments.file);
  if (arguments.line.use_sim_time.value_or(false)) {
    throw ConfigurationError(
        "use_sim_time: a .music file follows no clock of ROS; leave it out, or write an experiment "
        "with  sync: sim_time");
  }
  check_ros_arguments(arguments.line, versions_of(file, arguments.job.run), false);
  add_ros_arguments(arguments.line.ros, arguments.job);
  if (!arguments.job.folder.empty() && !arguments.dry_run) {
    arguments.job.versions = about_run(partners_of(file, arguments.job.robot)).dump(2) + "\n";
  }
  launch::Job job(file, arguments.job);
  if (arguments.dry_run) {
    return dry_run(job, launch::check_job(file, arguments.job.run), arguments.file);
  }
  if (arguments.job.hostfile.empty()) {
    require_resources(needs_of(job.effective().file, arguments.job, false,
                               [](const std::string&) { return true; }));
  }
  std::optional<launch::RunFolder> folder;
  if (!arguments.job.folder.empty()) {
    launch::refuse_to_overwrite(file.path, arguments.job.folder + "/effective.music");
    folder.emplace(arguments.job.folder, "", arguments.force);
  }
  return run_job(job, volume_of(arguments));
}

}  // namespace

void add(CLI::App& app, const topics::CommandLine& line, Action& action) {
  CLI::App* command = app.add_subcommand("run", "Run an experiment file or a .music file");
  const auto arguments = std::make_shared<RunArguments>();
  arguments->line = line;
  add_options(*command, *arguments);
  add_experiment_options(*command, *arguments);
  command->footer(kFooter);
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace spikeloop::app::run_command
