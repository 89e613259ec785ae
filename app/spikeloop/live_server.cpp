#include "live_server.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/random.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <map>
#include <utility>
#include <vector>

#include "output.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/live/feed.hpp"
#include "spikeloop/processes/descendants.hpp"
#include "spikeloop/processes/python.hpp"

namespace spikeloop::app {
namespace {

constexpr TimeNs kLongestStart = 5 * kNsPerSecond;
constexpr std::chrono::milliseconds kWatchPeriod{100};

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw TransportError("there are no random numbers for the token of the live view");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

/// The first line, or what it complains of.
std::string first_line(const ProcessTree& server) {
  std::string text;
  std::string complaint;
  const TimeNs end = wall_now() + kLongestStart;
  std::array<pollfd, 2> ends{pollfd{server.out(), POLLIN, 0}, pollfd{server.err(), POLLIN, 0}};
  while (wall_now() < end && text.find('\n') == std::string::npos &&
         (ends[0].fd >= 0 || ends[1].fd >= 0)) {
    ::poll(ends.data(), ends.size(), 100);
    for (pollfd& from : ends) {
      std::array<char, 4096> bytes{};
      const ssize_t size = from.fd < 0 ? 0 : ::read(from.fd, bytes.data(), bytes.size());
      if (size > 0) {
        (&from == &ends[0] ? text : complaint).append(bytes.data(), static_cast<std::size_t>(size));
      } else if (size == 0) {
        from.fd = -1;
      }
    }
  }
  if (text.find('\n') == std::string::npos) {
    throw TransportError(complaint.empty() ? "the live view does not start within 5 s"
                                           : complaint.substr(0, complaint.find('\n')));
  }
  return text.substr(0, text.find('\n') + 1);
}

bool is_this_machine(const std::string& host) {
  return host.starts_with("127.");
}

}  // namespace

void add_address_options(CLI::App& command, LiveOptions& options) {
  command.add_option("--live-port", options.port, "Port of the live view; 0: any")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      .add_option("--live-host", options.host,
                  "Address of this machine for viewers on others, such as 0.0.0.0; only those with "
                  "the printed URL can control the run, all can stop the robot")
      ->capture_default_str();
}

LiveServer::LiveServer(const LiveOptions& options, const std::string& run_folder,
                       const std::string& name, bool recording) {
  std::vector<std::string> words{own_directory() + "/spikeloop-live",
                                 "--feeds=" + folder_.path(),
                                 "--run=" + run_folder,
                                 "--name=" + name,
                                 "--host=" + options.host,
                                 fmt::format("--port={}", options.port)};
  if (recording) {
    words.emplace_back("--recording");
  }
  std::map<std::string, std::string> environment;
  if (!is_this_machine(options.host)) {
    environment[live::kTokenVariable] = make_token();
  }
  server_.emplace(ProgramStart{.arguments = words,
                               .environment = environment,
                               .directory = {},
                               .kept = folder_.descriptor()});
  put(stderr, first_line(*server_));
  ::setenv(live::kFolderVariable, folder_.path().c_str(), 1);
  if (!recording) {
    watch_ = std::thread([this] { watch(); });
  }
}

void LiveServer::require_alive() {
  if (server_->gone()) {
    throw TransportError(
        with_code(Code::partner_failed,
                  "spikeloop-live, the server of the live view, has ended; start the view again"));
  }
}

/// Warns once when the server has ended, and whenever it is stopped.
void LiveServer::watch() {
  bool stopped = false;
  while (!ending_.load()) {
    if (server_->gone()) {
      log::warning(
          "spikeloop-live has ended: there is no live view and no STOP button any more; Ctrl-C "
          "stops the robot");
      return;
    }
    const bool before = std::exchange(stopped, is_stopped(server_->pid()));
    if (stopped && !before) {
      log::warning(
          "spikeloop-live has been stopped (SIGSTOP): its STOP button does nothing; Ctrl-C stops "
          "the robot, and  kill -CONT {}  continues the live view",
          server_->pid());
    }
    std::this_thread::sleep_for(kWatchPeriod);
  }
}

LiveServer::~LiveServer() {
  ending_.store(true);
  if (watch_.joinable()) {
    watch_.join();
  }
  server_->end();
}

}  // namespace spikeloop::app
