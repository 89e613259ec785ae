#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <utility>

#include "spikeloop/status/address.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::status {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

constexpr milliseconds kPatience{1000};
constexpr milliseconds kLoopPatience{10};
constexpr std::size_t kLongestMessage = 64 * 1024;

Descriptor connect_to_launcher() {
  const char* path = std::getenv(kSocketVariable);
  const auto address = path == nullptr ? std::nullopt : socket_address(path);
  if (!address) {
    return Descriptor{};
  }
  Descriptor fd{socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  enlarge(fd.get(), SO_SNDBUF);
  if (connect(fd.get(), generic(*address), sizeof *address) != 0) {
    fd.reset();
  }
  return fd;
}

/// Returns false only when the text is too large for a datagram.
bool send_text(int fd, const std::string& text, milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (send(fd, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL) < 0) {
    if (errno == EMSGSIZE || errno == ENOBUFS) {
      return false;
    }
    const auto left =
        std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now());
    const bool may_succeed_later = errno == EAGAIN || errno == EINTR;
    if (!may_succeed_later || left.count() <= 0) {
      return true;
    }
    pollfd waiting{fd, POLLOUT, 0};
    poll(&waiting, 1, static_cast<int>(left.count()));
  }
  return true;
}

void add(const Reached& reached, json& message) {
  message["simulated_s"] = to_seconds(reached.simulated);
  message["wall_s"] = to_seconds(reached.wall);
  message["overruns"] = reached.overruns;
}

std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

constexpr std::array kPhaseNames{"preparing", "meeting",    "waiting",
                                 "computing", "exchanging", "finalizing"};

}  // namespace

const char* name_of(Phase phase) {
  return kPhaseNames.at(static_cast<std::size_t>(phase));
}

std::optional<Phase> phase_named(std::string_view name) {
  const auto found = std::find(kPhaseNames.begin(), kPhaseNames.end(), name);
  return found == kPhaseNames.end()
             ? std::nullopt
             : std::optional(static_cast<Phase>(found - kPhaseNames.begin()));
}

Sender::Sender(std::string process)
    : process_(std::move(process)), socket_(connect_to_launcher()) {}

json Sender::message(const char* type) const {
  return {{"type", type}, {"process", process_}};
}

void Sender::started() const {
  if (socket_.get() < 0) {
    return;
  }
  json started = message("started");
  started["pid"] = getpid();
  send_text(socket_.get(), text_of(started), kPatience);
}

void Sender::first_tick() const {
  if (socket_.get() >= 0) {
    send_text(socket_.get(), text_of(message("first_tick")), kLoopPatience);
  }
}

void Sender::progress(const Reached& reached, const json& extra) const {
  if (socket_.get() < 0) {
    return;
  }
  json progress = message("progress");
  if (extra.is_object()) {
    progress.update(extra);
  }
  add(reached, progress);
  send_text(socket_.get(), text_of(progress), milliseconds{0});
}

void Sender::alive(Phase phase, TimeNs simulated) const {
  if (socket_.get() < 0) {
    return;
  }
  json alive = message("alive");
  alive["phase"] = name_of(phase);
  alive["simulated_s"] = to_seconds(simulated);
  send_text(socket_.get(), text_of(alive), milliseconds{0});
}

void Sender::terminated() const {
  if (socket_.get() >= 0) {
    send_text(socket_.get(), text_of(message("terminated")), milliseconds{0});
  }
}

void Sender::report(const json& counters, const json& summary,
                    const std::optional<Reached>& reached) const {
  if (socket_.get() < 0) {
    return;
  }
  json report = message("report");
  if (reached) {
    add(*reached, report);
  }
  report["counters"] = counters.is_object() ? counters : json::object();
  report["summary"] = summary.is_object() ? summary : json::object();
  const std::string text = text_of(report);
  if (!send_text(socket_.get(), text, kPatience)) {
    report["counters"] = report["summary"] = json::object();
    report["too_large"] = text.size();
    send_text(socket_.get(), text_of(report), kPatience);
  }
}

void Sender::failure(int exit_code, std::string_view message) const {
  if (socket_.get() < 0) {
    return;
  }
  json failure = this->message("failure");
  failure["exit_code"] = exit_code;
  failure["message"] = std::string(message.substr(0, kLongestMessage));
  send_text(socket_.get(), text_of(failure), kPatience);
}

}  // namespace spikeloop::status
