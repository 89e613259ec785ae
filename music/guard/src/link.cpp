#include "spikeloop/guard/link.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "spikeloop/core/log.hpp"
#include "spikeloop/guard/guard_timer.hpp"
#include "spikeloop/status/address.hpp"

namespace spikeloop::guard {
namespace {

/// Longer than the guard itself waits for a ROS master.
constexpr TimeNs kPatience = 5 * kNsPerSecond;

/// Returns 0 or an errno.
int connect_to(const std::string& path, Descriptor& into) {
  const auto address = status::socket_address(path);
  if (!address) {
    return ENAMETOOLONG;
  }
  // Does not wait: a guard that is stopped would keep us waiting for ever.
  into = Descriptor{socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  status::enlarge(into.get(), SO_SNDBUF);
  return connect(into.get(), status::generic(*address), sizeof *address) == 0 ? 0 : errno;
}

}  // namespace

Link::Link(const Hello& hello) {
  const char* const path = std::getenv(kSocketVariable);
  if (path == nullptr || *path == '\0') {
    return;
  }
  if (const int error = connect_to(path, socket_); error != 0) {
    go_without(
        fmt::format("no guard answers at '{0}' ({1}); start one with spikeloop-guard --socket {0}, "
                    "or unset {2}",
                    path, std::strerror(error), kSocketVariable));
    return;
  }
  introduce(hello);
}

void Link::introduce(const Hello& hello) {
  if (const int error = send_packet(socket_.get(), to_packet(hello)); error != 0) {
    go_without(fmt::format("the guard could not be told about {} ({})", hello.topic,
                           std::strerror(error)));
    return;
  }
  if (!wait_readable(socket_.get(), kPatience)) {
    go_without(fmt::format("the guard does not answer within {}", format_time(kPatience)));
    return;
  }
  const Received answer = receive_packet(socket_.get());
  const std::string type = type_of(answer.packet);
  if (type == "ready") {
    guarded_.store(true);
  } else if (type == "refused") {
    go_without("the guard refuses: " + text_of(answer.packet, "reason"));
  } else {
    go_without("the guard has ended");
  }
}

void Link::go_without(const std::string& reason) {
  log::warning("{}. Nothing stops the robot when this program is killed or stopped", reason);
}

bool Link::reaches_robot() {
  while (guarded_.load() && !reaches_) {
    const Received news = receive_packet(socket_.get());
    if (news.nothing || news.closed) {
      return news.closed;  // of which the next beat tells
    }
    reaches_ = type_of(news.packet) == "reaches";
  }
  return true;
}

TimeNs Link::beat(TimeNs now) {
  if (!guarded_.load()) {
    return kNever;
  }
  const int error = send_packet(socket_.get(), make_packet("beat"));
  // A guard that is late has enough beats to read.
  if (error != 0 && error != EAGAIN && guarded_.exchange(false)) {
    go_without("the guard has ended");
    return kNever;
  }
  return now + kBeatPeriod;
}

void Link::abandon() {
  if (guarded_.exchange(false)) {
    ::shutdown(socket_.get(), SHUT_RDWR);
  }
}

void Link::done() {
  if (guarded_.exchange(false)) {
    send_packet(socket_.get(), make_packet("done"));
  }
}

}  // namespace spikeloop::guard
