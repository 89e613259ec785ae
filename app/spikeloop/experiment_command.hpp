// Experiment files: what `spikeloop run` and `spikeloop check` do with them.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "console.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::app {

/// By its name: .yaml or .yml.
bool is_experiment(const std::string& file);

enum class Layout { fused, separate };

struct ExperimentArguments {
  std::string file;
  std::string folder;  ///< empty: runs/NAME-N
  bool record = true;
  double stall_timeout_s = 60;  ///< 0: for ever; over ROS or MUSIC
  Layout layout = Layout::fused;
  experiment::Overrides overrides;
  Console::Volume volume = Console::Volume::normal;
};

/// Returns the exit code. @throws Error when it cannot begin.
int run_experiment(const ExperimentArguments& arguments);

/// Writes the separate layout into a folder: experiment.music, and what stands in the experiment
/// but has to be a file for a process. Returns the path of experiment.music.
std::string write_music_job(const experiment::Experiment& experiment, const std::string& folder);

/// Gives an experiment that is right to `use`; else says everything that is wrong, each with its
/// line. Returns the exit code.
int use_experiment(const std::string& file,
                   const std::function<int(const experiment::Experiment&)>& use);

/// Says everything that is wrong, each with its line. Returns the exit code.
int check_experiment(const std::string& file);

}  // namespace spikeloop::app
