#include "live_server.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <utility>
#include <vector>

#include "output.hpp"
#include "spikeloop/core/background.hpp"
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
constexpr int kWatchMs = 100;

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

}  // namespace

void add_address_options(CLI::App& command, LiveOptions& options) {
  command.add_option("--live-port", options.port, "Port of the live view; 0: any")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      .add_option("--live-host", options.host,
                  "IPv4 address to listen at; 0.0.0.0: all. Every viewer can watch and press STOP; "
                  "control needs the printed URL")
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
  server_.emplace(ProgramStart{
      .arguments = words, .environment = {}, .directory = {}, .kept = folder_.descriptor()});
  put(stderr, first_line(*server_));
  watch_ = background_thread([this, recording] { watch(recording); });
  ::setenv(live::kFolderVariable, folder_.path().c_str(), 1);
}

void LiveServer::require_alive() {
  if (server_->gone()) {
    throw TransportError(
        with_code(Code::partner_failed,
                  "spikeloop-live, the server of the live view, has ended; start the view again"));
  }
}

/// Prints what the server reports, such as requests that it refuses, until the server has ended.
void LiveServer::watch(bool recording) {
  std::string text;
  std::array<char, 4096> bytes{};
  pollfd error{server_->err(), POLLIN, 0};
  while (!ended_) {
    const ssize_t size =
        ::poll(&error, 1, kWatchMs) == 1 ? ::read(error.fd, bytes.data(), bytes.size()) : -1;
    text.append(bytes.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    if (const std::size_t end = text.rfind('\n'); end != std::string::npos) {
      put(stderr, text.substr(0, end + 1));
      text.erase(0, end + 1);
    }
    error.fd = size == 0 ? -1 : error.fd;
    if (!recording && !warn_if_lost()) {
      return;
    }
  }
}

/// Warns if STOP has no effect because the server has ended or is stopped. Returns false if it has
/// ended.
bool LiveServer::warn_if_lost() {
  if (server_->gone()) {
    log::warning(
        "spikeloop-live has ended: the live view has ended, and STOP remains as it is; Ctrl-C ends "
        "the run and stops the robot");
    return false;
  }
  const bool before = std::exchange(stopped_, is_stopped(server_->pid()));
  if (stopped_ && !before) {
    log::warning(
        "spikeloop-live has been stopped (SIGSTOP): its STOP button does nothing; Ctrl-C stops the "
        "robot, and  kill -CONT {}  continues the live view",
        server_->pid());
  }
  return true;
}

LiveServer::~LiveServer() {
  ended_ = true;
  watch_.join();
  server_->end();
}

}  // namespace spikeloop::app
