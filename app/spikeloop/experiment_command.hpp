// Experiment files: what `spikeloop run` and `spikeloop check` do with them.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "console.hpp"
#include "live_server.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/experiment/music_job.hpp"
#include "spikeloop/launch/run_folder.hpp"
#include "spikeloop/robot/spectators.hpp"
#include "spikeloop/topics/arguments.hpp"

namespace spikeloop::app {

/// By its name: .yaml or .yml.
bool is_experiment(const std::string& file);

struct ExperimentArguments {
  std::string file;
  std::string folder;  ///< empty: runs/NAME-N
  bool force = false;  ///< replaces results in it
  bool record = true;
  experiment::Overrides overrides;
  /// Of a run in several processes.
  std::chrono::milliseconds start_timeout{60'000};
  std::chrono::milliseconds stall_timeout{60'000};
  std::string timeout_given{};  ///< the option, when one of them was
  Console::Volume volume = Console::Volume::normal;
  robot::SpectatorWords spectators{};  ///< of the robot
  topics::CommandLine line{};          ///< what it has for ROS
  LiveOptions live{};
};

/// Returns the exit code. @throws Error when it cannot begin.
int run_experiment(const ExperimentArguments& arguments);

/// Loads an experiment that is to be run, and says the first thing that is wrong with it.
std::unique_ptr<experiment::Loaded> load_experiment(const std::string& file,
                                                    const experiment::Overrides& overrides);

/// Runs an experiment without ROS to its end, or until a signal comes. Returns the exit code.
int run_in_process(const experiment::Experiment& experiment, const launch::RunFolder& folder,
                   bool record, Console::Volume volume,
                   const robot::SpectatorOptions& spectators = {});

/// Runs the processes of an experiment, beside the ROS master, the robot and the guard: as a MUSIC
/// job when there are several. Returns the exit code.
int run_processes(const ExperimentArguments& arguments, const experiment::Experiment& experiment,
                  const launch::RunFolder& folder);

/// A job in a folder.
struct WrittenJob {
  std::string path;  ///< of experiment.music
  /// Puts places of the experiment in place of those of experiment.music.
  std::function<std::string(const std::string&)> places;
};
/// Writes experiment.music, and what stands in the experiment but has to be a file for a process.
WrittenJob write_job(const experiment::MusicJob& job, const std::string& folder);
/// The job of programs with the older names, a program a node.
WrittenJob write_music_job(const experiment::Experiment& experiment, const std::string& folder);

/// Gives an experiment that is right to `use`; else says everything that is wrong, each with its
/// line. Returns the exit code.
int use_experiment(const std::string& file,
                   const std::function<int(const experiment::Experiment&)>& use);

struct CheckOptions {
  bool strict = false;  ///< warnings have the exit code of errors
  bool json = false;    ///< prints the experiment as resolved.json has it
};
/// Says everything that is wrong, each with its line. Returns the exit code.
int check_experiment(const std::string& file, const Settings& settings,
                     const CheckOptions& options);

}  // namespace spikeloop::app
