// spikeloop-guard: stops the robot when its command adapter cannot.
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "server.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/priority.hpp"
#include "spikeloop/status/deadline.hpp"

namespace {

using namespace spikeloop;

constexpr const char* kDescription =
    "Stops the robot when its command adapter is killed (SIGKILL), stopped (SIGSTOP) or crashes.\n"
    "`spikeloop run` starts a guard for every job that commands a robot over ROS.\n"
    "\n"
    "Command adapters connect to the socket whose path is in SPIKELOOP_GUARD. If one ends and has\n"
    "not stopped its robot, or is silent for 100 ms longer than its watchdog, the guard sends its\n"
    "stop command five times in 200 ms.";

constexpr const char* kExamples =
    "Example: a job that is started manually\n"
    "  spikeloop-guard --socket /tmp/guard &\n"
    "  SPIKELOOP_GUARD=/tmp/guard mpirun -np 3 music loop.music\n"
    "  kill %1                                       or Ctrl-C: ends the guard, not the job\n"
    "\n"
    "Exit codes: 0 stopped, or the launcher has ended, 2 invalid option, 4 the socket cannot be\n"
    "created. If the ROS master is missing, the adapter is notified and runs without a guard.";

const char* level_name(log::Level level) {
  return level == log::Level::warning ? "warning" : level == log::Level::error ? "error" : "info";
}

/// Sends the message to the launcher, or prints it if there is no launcher.
void say(int owner, log::Level level, std::string_view text) {
  const guard::Packet packet{"log", {{"level", level_name(level)}, {"text", std::string(text)}}};
  if (owner < 0 || guard::send_packet(owner, packet) != 0) {
    fmt::print(stderr, "spikeloop-guard: {}{}\n", level == log::Level::warning ? "warning: " : "",
               text);
  }
}

int run(const std::string& socket, int owner) {
  try {
    guard::Server server(socket, owner);
    server.run();
    return status::end_in_time(0);
  } catch (const Error& error) {
    log::write(log::Level::error, error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    log::write(log::Level::error, error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string socket;
  int owner = -1;
  CLI::App app(kDescription, "spikeloop-guard");
  app.set_version_flag("--version", std::string("spikeloop-guard ") + SPIKELOOP_VERSION);
  app.footer(kExamples);
  app.add_option("--socket", socket, "Path of the new socket, at most 107 bytes")->required();
  app.add_option("--owner", owner, "Socket to the launcher; the guard ends after the launcher")
      ->type_name("FD")
      ->check(CLI::Range(3, 1 << 20));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  signal(SIGPIPE, SIG_IGN);
  run_before_others();
  if (owner >= 0) {
    fcntl(owner, F_SETFD, FD_CLOEXEC);
  }
  log::set_sink([&](log::Level level, std::string_view text) { say(owner, level, text); });
  return run(socket, owner);
}
