#include "simulator_check.hpp"

#include <fmt/format.h>

#include <map>

#include "doctor/children.hpp"
#include "python_package.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::app {
namespace {

using experiment::Node;
using experiment::Simulator;

constexpr const char* kFindModule =
    "import importlib.util, sys; sys.exit(importlib.util.find_spec(sys.argv[1]) is None)";

/// What is wrong with it; empty: nothing.
std::string trouble_with(const Simulator& simulator) {
  const std::string python = python_program();
  if (python.empty()) {
    return "there is no Python to run its script; install it (Debian: apt install python3), or set "
           "PYTHON";
  }
  if (std::string_view(simulator.module).empty()) {
    return "";
  }
  const doctor::Command command{python, "-c", kFindModule, simulator.module};
  const doctor::Answer answer = doctor::ask({command}).front();
  // One that takes too long may have it all the same: the run will tell.
  return answer.failure.empty() || !answer.in_time
             ? ""
             : fmt::format("{} finds no module '{}'; {}", python, simulator.module,
                           simulator.install);
}

}  // namespace

void check_simulators(const experiment::Experiment& experiment, Diagnostics& diagnostics) {
  std::map<std::string, std::string> known;
  for (const Node& node : experiment.nodes) {
    if (!experiment::is_simulator(node)) {
      continue;
    }
    const auto [trouble, is_new] = known.emplace(node.kind, "");
    if (is_new) {
      trouble->second = trouble_with(*experiment::find_simulator(node.kind));
    }
    if (!trouble->second.empty()) {
      diagnostics.push_back({node.where,
                             fmt::format("node '{}': simulator '{}' is not installed: {}",
                                         node.name, node.kind, trouble->second),
                             TransportError::kExitCode});
    }
  }
}

}  // namespace spikeloop::app
