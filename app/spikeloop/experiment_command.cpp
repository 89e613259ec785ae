#include "experiment_command.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "experiment_folder.hpp"
#include "output.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/experiment/music_job.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/launch/folders.hpp"

namespace spikeloop::app {
namespace {

using experiment::Experiment;
using experiment::Fault;

/// The line of the file, and a caret below the place.
std::string source_line(const Location& where) {
  if (where.line <= 0) {
    return "";
  }
  std::ifstream file(where.file);
  std::string line;
  for (int i = 0; i < where.line; ++i) {
    if (!std::getline(file, line)) {
      return "";
    }
  }
  const std::string number = fmt::format("{:>5} | ", where.line);
  std::string text = fmt::format("{}{}\n", number, one_line(line));
  if (where.column > 0) {
    text += fmt::format("{:>{}}\n", "^", static_cast<int>(number.size()) + where.column);
  }
  return text;
}

std::string text_of(const char* kind, const Fault& fault) {
  return fmt::format("{}: {}\n{}", kind, fault.text, source_line(fault.where));
}

std::atomic<int> signal_number{0};

/// The first one ends the loop, the second one the process.
void take_signal(int number) {
  if (signal_number.exchange(number) != 0) {
    ::_exit(128 + number);
  }
}

void take_signals() {
  struct sigaction action {};
  action.sa_handler = take_signal;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1}) {
    ::sigaction(number, &action, nullptr);
  }
}

launch::Progress for_console(const fused::Progress& progress, const Experiment& experiment) {
  launch::Progress shown{
      to_seconds(progress.simulated), to_seconds(progress.wall), {}, progress.overruns};
  if (experiment.duration) {
    shown.total_s = to_seconds(*experiment.duration);
  }
  return shown;
}

std::string count(std::size_t number, const char* what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

void tell_folder(const ExperimentArguments& arguments, const ExperimentFolder& folder) {
  if (arguments.volume != Console::Volume::quiet) {
    put(stderr, fmt::format("spikeloop: run folder: {}\n", folder.shown()));
  }
}

int run_fused(const ExperimentArguments& arguments, const Experiment& experiment) {
  const ExperimentFolder folder(arguments.folder, experiment.name);
  const BackgroundOutput output;
  Console console(arguments.volume);
  log::set_sink(
      [&console](log::Level level, std::string_view message) { console.log(level, message); });
  take_signals();
  launch::Progress last;
  const fused::RunEvents events{.progress =
                                    [&](const fused::Progress& progress) {
                                      last = for_console(progress, experiment);
                                      console.progress(last);
                                    },
                                .stop = [] { return signal_number.load() != 0; }};
  const fused::RunResult result =
      fused::run(experiment, {.folder = folder.path(), .record = arguments.record}, events);
  log::set_sink({});
  launch::JobResult end{result.exit_code, result.reason, {}};
  if (const int number = signal_number.load(); number != 0 && result.exit_code == 0) {
    end.exit_code = 128 + number;
    end.reason = fmt::format("stopped by SIG{}", ::sigabbrev_np(number));
  }
  console.end(end, last);
  tell_folder(arguments, folder);
  return end.exit_code;
}

/// The robot that the experiment has, started when nobody publishes its topics.
void add_robot(const Experiment& experiment, launch::JobOptions& options) {
  if (!experiment.robot) {
    return;
  }
  options.roscore = true;
  options.robot = true;
  options.robot_arguments = {fmt::format("--world={}", experiment.robot->world),
                             fmt::format("--seed={}", experiment.robot->seed)};
}

/// One process and its partners: master, robot, guard.
int run_fused_over_ros(const ExperimentArguments& arguments, const Experiment& experiment) {
  ExperimentFolder folder(arguments.folder, experiment.name);
  folder.release();
  MusicFile file;
  file.path = experiment.path;
  file.sections.push_back({"experiment", {}, {experiment.path, 0, 0}});
  auto& keys = file.sections.front().keys;
  set_key(keys, "binary", "spikeloop-fused");
  set_key(keys, "np", "1");
  set_key(keys, "seed", std::to_string(experiment.seed));
  set_key(keys, "rtf", fmt::format("{}", experiment.real_time_factor));
  set_key(keys, "music_timestep", fmt::format("{}", to_seconds(experiment.tick)));
  launch::JobOptions options;
  options.folder = folder.path();
  options.program = {"spikeloop-fused",
                     std::filesystem::absolute(arguments.file).string(),
                     "--out",
                     folder.path(),
                     fmt::format("--seed={}", experiment.seed),
                     fmt::format("--real-time-factor={}", experiment.real_time_factor),
                     fmt::format("--sync={}", experiment::name_of(experiment.sync))};
  if (experiment.duration) {
    set_key(keys, "stoptime", fmt::format("{}", to_seconds(*experiment.duration)));
    options.program.push_back(fmt::format("--duration={}", to_seconds(*experiment.duration)));
  }
  if (!arguments.record) {
    options.program.emplace_back("--no-record");
  }
  add_robot(experiment, options);
  launch::Job job(file, options);
  const int exit_code = run_job(job, arguments.volume);
  tell_folder(arguments, folder);
  return exit_code;
}

/// Returns the job's file, with the places that programs will name.
MusicFile write_job(const experiment::MusicJob& job, const std::string& folder) {
  for (const auto& [name, contents] : job.files) {
    launch::write_text(folder + "/" + name, contents);
  }
  const std::string path = folder + "/experiment.music";
  launch::write_text(path, to_text(job.file));
  return read_music_file(path);
}

int run_separate(const ExperimentArguments& arguments, const Experiment& experiment) {
  ExperimentFolder folder(arguments.folder, experiment.name);
  const experiment::MusicJob music = experiment::music_job(experiment, folder.path());
  const MusicFile file = write_job(music, folder.path());
  launch::write_text(folder.path() + "/resolved.json",
                     fused::resolved_json(experiment).dump(2) + "\n");
  folder.release();
  launch::JobOptions options;
  options.folder = folder.path();
  options.run.record = arguments.record;
  add_robot(experiment, options);
  launch::Job job(file, options);
  const int exit_code = run_job(job, arguments.volume);
  tell_folder(arguments, folder);
  return exit_code;
}

}  // namespace

bool is_experiment(const std::string& file) {
  return file.ends_with(".yaml") || file.ends_with(".yml");
}

int run_experiment(const ExperimentArguments& arguments) {
  const auto all = experiment::load(arguments.file, arguments.overrides);
  const experiment::Loaded& loaded = *all;
  if (!loaded.faults.empty()) {
    put(stderr, text_of("spikeloop", loaded.faults.front()));
    if (loaded.faults.size() > 1) {
      put(stderr, fmt::format("spikeloop: {} more; see  spikeloop check {}\n",
                              count(loaded.faults.size() - 1, "error"), arguments.file));
    }
    return loaded.faults.front().exit_code;
  }
  const Experiment& experiment = *loaded.experiment;
  if (arguments.layout == Layout::separate) {
    return run_separate(arguments, experiment);
  }
  return experiment.ros == experiment::Ros::none ? run_fused(arguments, experiment)
                                                 : run_fused_over_ros(arguments, experiment);
}

int check_experiment(const std::string& file) {
  const auto all = experiment::load(file, {});
  const experiment::Loaded& loaded = *all;
  for (const Fault& fault : loaded.faults) {
    put(stderr, text_of("error", fault));
  }
  if (!loaded.faults.empty()) {
    put(stderr, fmt::format("spikeloop: {}: {}\n", file, count(loaded.faults.size(), "error")));
    return loaded.faults.front().exit_code;
  }
  const Experiment& experiment = *loaded.experiment;
  put_result(fmt::format(
      "{}: nothing to complain about: {}, {}, tick {}, {}\n", file,
      count(experiment.parts.size(), "node"), count(experiment.links.size(), "connection"),
      format_time(experiment.tick),
      experiment.duration ? format_time(*experiment.duration) : "runs until it is stopped"));
  return 0;
}

}  // namespace spikeloop::app
