// spikeloop-guard: stops the robot when its command adapter cannot.
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <thread>

#include "server.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/priority.hpp"

namespace {

using namespace spikeloop;

/// From the end of our work to that of the process, whatever the ROS master does.
constexpr std::chrono::milliseconds kLongestEnd{1000};

const char* level_name(log::Level level) {
  return level == log::Level::warning ? "warning" : level == log::Level::error ? "error" : "info";
}

/// To the launcher, which shows it; to the screen when there is none, or none any more.
void say(int owner, log::Level level, std::string_view text) {
  auto packet = guard::make_packet("log");
  packet["level"] = level_name(level);
  packet["text"] = text;
  if (owner < 0 || guard::send_packet(owner, packet) != 0) {
    fmt::print(stderr, "spikeloop-guard: {}{}\n", level == log::Level::warning ? "warning: " : "",
               text);
  }
}

/// Leaving ROS asks the master, which may have gone, or hang.
void end_in_time() {
  std::thread([] {
    std::this_thread::sleep_for(kLongestEnd);
    _exit(0);
  }).detach();
}

int run(const guard::Options& options) {
  try {
    guard::Server server(options);
    server.run();
    end_in_time();
    return 0;
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
  int exit_code = 0;
  const auto options = guard::parse_options(argc, argv, exit_code);
  if (!options) {
    return exit_code;
  }
  signal(SIGPIPE, SIG_IGN);
  run_before_others();
  if (options->owner >= 0) {
    fcntl(options->owner, F_SETFD, FD_CLOEXEC);
  }
  log::set_sink([&](log::Level level, std::string_view text) { say(options->owner, level, text); });
  return run(*options);
}
