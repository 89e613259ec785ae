#include <fmt/format.h>
#include <signal.h>

#include <atomic>
#include <cstdio>
#include <string>
#include <vector>

#include "run.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/topics/arguments.hpp"

namespace {

std::atomic<bool> stop = false;

void ask_to_stop(int) {
  stop = true;
}

void handle_signals() {
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) ::sigaction(number, &action, nullptr);
}

int fail(const spikeloop::status::Sender& status, int exit_code, const std::string& message) {
  fmt::print(stderr, "spikeloop-robot: {}\n", message);
  status.failure(exit_code, message);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace spikeloop;
  log::set_sink([](log::Level level, std::string_view text) {
    fmt::print(stderr, "spikeloop-robot: {}{}\n", level == log::Level::warning ? "warning: " : "",
               text);
  });
  const status::Sender status("robot");
  try {
    topics::CommandLine line = topics::split_command_line(argc, argv);
    for (const std::string& foreign : line.foreign) {
      log::warning("'{}' (behind --ros-args) means nothing to this robot and is ignored", foreign);
    }
    std::vector<char*> pointers;
    pointers.reserve(line.own.size() + 1);
    for (auto& argument : line.own) pointers.push_back(argument.data());
    int exit_code = 0;
    const auto options =
        robot::parse_options(static_cast<int>(pointers.size()), pointers.data(), exit_code);
    if (!options) return exit_code;
    handle_signals();
    (options->step ? robot::run_stepped : robot::run)(*options, line.ros, status, stop);
  } catch (const Error& error) {
    return fail(status, error.exit_code(), error.what());
  } catch (const std::exception& error) {
    return fail(status, 1, error.what());
  }
  return 0;
}
