// spikeloop-guard: stops the robot when its command adapter cannot.
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>

#include <cstdio>

#include "server.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/priority.hpp"
#include "spikeloop/status/deadline.hpp"

namespace {

using namespace spikeloop;

const char* level_name(log::Level level) {
  return level == log::Level::warning ? "warning" : level == log::Level::error ? "error" : "info";
}

/// To the launcher, which shows it; to the screen when there is none, or none any more.
void say(int owner, log::Level level, std::string_view text) {
  auto packet = guard::make_packet("log");
  packet.fields["level"] = level_name(level);
  packet.fields["text"] = text;
  if (owner < 0 || guard::send_packet(owner, packet) != 0) {
    fmt::print(stderr, "spikeloop-guard: {}{}\n", level == log::Level::warning ? "warning: " : "",
               text);
  }
}

int run(const guard::Options& options) {
  try {
    guard::Server server(options);
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
