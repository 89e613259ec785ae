#include "options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

namespace spikeloop::guard {
namespace {

constexpr const char* kDescription =
    "Stops the robot when its command adapter cannot: killed by SIGKILL, stopped by SIGSTOP, or\n"
    "crashed. `spikeloop run` starts one beside every job that commands a robot over ROS.\n"
    "\n"
    "Command adapters that find the socket's path in SPIKELOOP_GUARD connect to it. When one goes\n"
    "without having stopped its robot, or is silent for 100 ms longer than its watchdog, the "
    "guard\n"
    "sends its zero command five times in 200 ms.";

constexpr const char* kExamples =
    "Example: a job started by hand\n"
    "  spikeloop-guard --socket /tmp/guard &\n"
    "  SPIKELOOP_GUARD=/tmp/guard mpirun -np 3 music loop.music\n"
    "  kill %1                                       or Ctrl-C: the guard ends, the job goes on\n"
    "\n"
    "Exit codes: 0 stopped, or the launcher has ended, 2 wrong option, 4 the socket could not be\n"
    "made. A ROS master that is missing is told to the adapter, which goes on without a guard.";

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, int& exit_code) {
  Options options;
  CLI::App app(kDescription, "spikeloop-guard");
  app.set_version_flag("--version", std::string("spikeloop-guard ") + SPIKELOOP_VERSION);
  app.footer(kExamples);
  app.add_option("--socket", options.socket, "Path of the socket to make, at most 107 bytes")
      ->required();
  app.add_option("--owner", options.owner,
                 "Descriptor of a socket to the launcher; the guard ends after it")
      ->type_name("FD")
      ->check(CLI::Range(3, 1 << 20));
  app.add_option(
      "--scratch", options.scratch,
      "The launcher's folder with the socket in it, removed when the launcher was killed");
  try {
    app.parse(argc, argv);
    const bool holds_socket =
        std::filesystem::path(options.socket).parent_path() == options.scratch;
    if (!options.scratch.empty() && !holds_socket) {
      throw CLI::ValidationError(
          "--scratch", fmt::format("'{}' is not the folder of the socket '{}'", options.scratch,
                                   options.socket));
    }
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  }
  return options;
}

}  // namespace spikeloop::guard
