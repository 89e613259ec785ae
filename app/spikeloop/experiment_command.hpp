// Experiment files: what `spikeloop run` and `spikeloop check` do with them.
#pragma once

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
  Layout layout = Layout::fused;
  experiment::Overrides overrides;
  Console::Volume volume = Console::Volume::normal;
};

/// Returns the exit code. @throws Error when it cannot begin.
int run_experiment(const ExperimentArguments& arguments);

/// Prints the .music file of the separate layout and mpirun's line; with a folder, writes the job
/// there. Returns the exit code.
int export_experiment(const std::string& file, const std::string& folder);

/// Says everything that is wrong, each with its line. Returns the exit code.
int check_experiment(const std::string& file);

}  // namespace spikeloop::app
