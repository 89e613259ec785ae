#include "../commands.hpp"

#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "../output.hpp"
#include "report.hpp"
#include "self.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/folders.hpp"

namespace spikeloop::app::doctor_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop doctor
  PYTHON=~/nest/bin/python3 spikeloop doctor      of another Python
  spikeloop doctor --json

Starts no job. Everything that may hang or crash is looked at by a process of its own, all of them at
once, and is given up after 4 s. SPIKELOOP_PLUGIN_PATH, ROS_MASTER_URI and
ROS 2's variables (docs/ros2.md) are heeded.

Exit codes: 0 all that every spikeloop run needs is there, 3 something of it is missing. The rest
changes no exit code.)";

/// As https://no-color.org has it.
bool colour_wanted() {
  const char* const none = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  return isatty(STDOUT_FILENO) == 1 && (none == nullptr || *none == '\0') &&
         (terminal == nullptr || std::string_view(terminal) != "dumb");
}

std::vector<doctor::Probe> all_probes(const std::string& scratch) {
  std::vector<doctor::Probe> probes;
  const auto add = [&probes](std::vector<doctor::Probe> more) {
    std::move(more.begin(), more.end(), std::back_inserter(probes));
  };
  add(doctor::own_probes());
  add(doctor::mpi_probes(scratch));
  add(doctor::plugin_probes());
  add(doctor::machine_probes());
  add(doctor::ros_probes());
  add(doctor::simulator_probes());
  add(doctor::python_probes());
  return probes;
}

/// A doctor goes on where there is no room for a folder: nobody else says what is wrong.
std::unique_ptr<launch::Scratch> make_scratch() {
  try {
    return std::make_unique<launch::Scratch>();
  } catch (const FileError&) {
    return nullptr;
  }
}

int examine(bool json) {
  const auto scratch = make_scratch();
  const auto items = doctor::examine(all_probes(scratch == nullptr ? "" : scratch->path()));
  if (json) {
    put_result(doctor::data(items).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
               "\n");
  } else {
    put_result(doctor::table(items, colour_wanted()));
  }
  return doctor::ready(items) ? 0 : TransportError::kExitCode;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  struct Arguments {
    bool json = false;
    std::vector<std::string> probe;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("doctor", "Say what of this machine Spikeloop can use");
  command->add_flag("--json", arguments->json, "Print the same as JSON");
  command->add_option("--probe", arguments->probe, "For its own children")
      ->allow_extra_args(false)
      ->group("");
  command->footer(kFooter);
  command->callback([arguments, &action] {
    action = [arguments] {
      return arguments->probe.empty() ? examine(arguments->json)
                                      : doctor::look_as_child(arguments->probe);
    };
  });
}

}  // namespace spikeloop::app::doctor_command
