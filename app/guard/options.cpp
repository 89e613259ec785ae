#include "options.hpp"

#include <CLI/CLI.hpp>

namespace spikeloop::guard {
namespace {

constexpr const char* kDescription =
    "Stops the robot when its command adapter is killed (SIGKILL), stopped (SIGSTOP) or crashes.\n"
    "`spikeloop run` starts a guard for every job that commands a robot over ROS.\n"
    "\n"
    "Command adapters connect to the socket whose path is in SPIKELOOP_GUARD. If one ends and has\n"
    "not stopped its robot, or is silent for 100 ms longer than its watchdog, the guard sends its\n"
    "zero command five times in 200 ms.";

constexpr const char* kExamples =
    "Example: a job that is started manually\n"
    "  spikeloop-guard --socket /tmp/guard &\n"
    "  SPIKELOOP_GUARD=/tmp/guard mpirun -np 3 music loop.music\n"
    "  kill %1                                       or Ctrl-C: ends the guard, not the job\n"
    "\n"
    "Exit codes: 0 stopped, or the launcher has ended, 2 invalid option, 4 the socket cannot be\n"
    "created. If the ROS master is missing, the adapter is notified and runs without a guard.";

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, int& exit_code) {
  Options options;
  CLI::App app(kDescription, "spikeloop-guard");
  app.set_version_flag("--version", std::string("spikeloop-guard ") + SPIKELOOP_VERSION);
  app.footer(kExamples);
  app.add_option("--socket", options.socket, "Path of the new socket, at most 107 bytes")
      ->required();
  app.add_option("--owner", options.owner,
                 "Socket to the launcher; the guard ends after the launcher")
      ->type_name("FD")
      ->check(CLI::Range(3, 1 << 20));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  }
  return options;
}

}  // namespace spikeloop::guard
