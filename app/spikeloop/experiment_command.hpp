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

struct ExperimentArguments {
  std::string file;
  std::string folder;  ///< empty: runs/NAME-N
  bool record = true;
  experiment::Overrides overrides;
  Console::Volume volume = Console::Volume::normal;
};

/// Returns the exit code. @throws Error when it cannot begin.
int run_experiment(const ExperimentArguments& arguments);

/// Gives an experiment that is right to `use`; else says everything that is wrong, each with its
/// line. Returns the exit code.
int use_experiment(const std::string& file,
                   const std::function<int(const experiment::Experiment&)>& use);

/// Says everything that is wrong, each with its line. Returns the exit code.
int check_experiment(const std::string& file);

}  // namespace spikeloop::app
