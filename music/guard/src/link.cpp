#include "spikeloop/guard/link.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/guard/guard_timer.hpp"
#include "spikeloop/status/address.hpp"

namespace spikeloop::guard {
namespace {

/// Time limit of the guard's answer. It is longer than the guard's own wait for a ROS master.
constexpr TimeNs kPatience = 5 * kNsPerSecond;
constexpr TimeNs kRetryPeriod = 100'000'000;

constexpr const char* kUnguarded = "Nothing stops the robot when this program is killed or stopped";

/// Returns 0 or an errno.
int connect_to(const std::string& path, Descriptor& into) {
  const auto address = status::socket_address(path);
  if (!address) {
    return ENAMETOOLONG;
  }
  // Does not wait: a guard that is stopped would otherwise block this program.
  into = Descriptor{socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  status::enlarge(into.get(), SO_SNDBUF);
  return connect(into.get(), status::generic(*address), sizeof *address) == 0 ? 0 : errno;
}

/// Must be called without the link's lock: output may block.
void print(const std::vector<std::pair<bool, std::string>>& lines) {
  for (const auto& [warning, text] : lines) {
    log::write(warning ? log::Level::warning : log::Level::info, text);
  }
}

}  // namespace

Link::Link(const Hello& hello) : hello_(hello) {
  const char* const path = std::getenv(kSocketVariable);
  if (path == nullptr || *path == '\0') {
    return;
  }
  path_ = path;
  Lines lines;
  const TimeNs now = wall_now();
  if (connect(now, lines)) {
    if (wait_readable(socket_.get(), kPatience)) {
      read(wall_now(), lines);
    } else {
      lose(fmt::format("the guard does not answer within {}", format_time(kPatience)), wall_now(),
           lines);
    }
  }
  print(lines);
  if (!ends_run_.empty()) {
    throw TransportError(fmt::format(
        "the guard of {} cannot become a node of ROS 2, so that nothing would stop the robot: {}",
        hello_.topic, ends_run_));
  }
}

bool Link::connect(TimeNs now, Lines& lines) {
  if (const int error = connect_to(path_, socket_); error != 0) {
    lose(fmt::format("no guard answers at '{0}' ({1}); start one with spikeloop-guard --socket {0},"
                     " or unset {2}",
                     path_, std::strerror(error), kSocketVariable),
         now, lines);
    return false;
  }
  if (const int error = send_packet(socket_.get(), to_packet(hello_)); error != 0) {
    lose(fmt::format("cannot register {} with the guard ({})", hello_.topic, std::strerror(error)),
         now, lines);
    return false;
  }
  stop_is_known_ = true;
  state_ = State::asked;
  due_ = now + kPatience;
  return true;
}

void Link::read(TimeNs now, Lines& lines) {
  while (state_ == State::asked || state_ == State::accepted) {
    const Received news = receive_packet(socket_.get());
    if (news.nothing) {
      return;
    }
    take(news, now, lines);
  }
}

void Link::take(const Received& news, TimeNs now, Lines& lines) {
  const std::string type = news.packet.type;
  if (news.closed) {
    lose("the guard has ended", now, lines);
    return;
  }
  heard_ = now;
  if (type == "ready") {
    state_ = State::accepted;
    was_accepted_ = true;
  } else if (type == "reaches") {
    reaches_.store(true);
    reached_ = true;
  } else if (type == "refused" && !was_accepted_ && !text_of(news.packet, kEndsRun).empty()) {
    ends_run_ = text_of(news.packet, "reason");
    leave(State::off);
  } else if (type == "refused") {
    lose("the guard refuses this adapter: " + text_of(news.packet, "reason"), now, lines);
    if (was_accepted_) {
      due_ = now + kPatience;  // the ROS master may not have answered a restarted guard
    } else {
      leave(State::off);
    }
  }
  guarded_.store(state_ == State::accepted);
  // A new guard may need seconds to discover a robot that the last one was connected to.
  if (guards(reached_) && std::exchange(lost_, false)) {
    lines.emplace_back(false, fmt::format("the guard watches over {} again", hello_.topic));
  }
}

/// Warns once, until a guard answers again.
void Link::lose(const std::string& reason, TimeNs now, Lines& lines) {
  leave(State::missing);
  due_ = now + kRetryPeriod;
  if (!std::exchange(lost_, true)) {
    lines.emplace_back(true, fmt::format("{}. {}", reason, kUnguarded));
  }
}

void Link::leave(State state) {
  state_ = state;
  guarded_.store(false);
  reaches_.store(false);
  socket_.reset();
}

void Link::check_silence(TimeNs now, Lines& lines) {
  if (guarded() && now - heard_ > kGuardSilence) {
    guarded_.store(false);
    lost_ = true;
    lines.emplace_back(
        true, fmt::format("the guard has not answered for {} (stopped by SIGSTOP, or the machine "
                          "is too busy). {}",
                          format_time(kGuardSilence), kUnguarded));
  }
}

void Link::set_stop(std::vector<std::byte> message) {
  const std::lock_guard lock(mutex_);
  stop_is_known_ = stop_is_known_ && message == hello_.stop;
  hello_.stop = std::move(message);
}

/// Waits until earlier packets are read, so that a guard that was stopped finds the newest message.
void Link::send_stop() {
  if (!stop_is_known_ && !has_unread(socket_.get())) {
    stop_is_known_ = send_packet(socket_.get(), stop_packet(hello_.stop)) == 0;
  }
}

TimeNs Link::beat(TimeNs now) {
  Lines lines;
  {
    const std::lock_guard lock(mutex_);
    if (state_ == State::missing && now >= due_) {
      connect(now, lines);
    }
    read(now, lines);
    if (state_ == State::asked && now >= due_) {
      leave(State::missing);
    }
    if (state_ == State::accepted) {
      check_silence(now, lines);
      send_stop();
      // Ignore errors: with a full socket the guard still has beats to read, and read() above
      // detects a guard that has ended.
      send_packet(socket_.get(), {"beat"});
    }
    if (state_ == State::off) {
      now = kNever - kBeatPeriod;
    }
  }
  print(lines);
  return now + kBeatPeriod;
}

void Link::abandon() {
  const std::lock_guard lock(mutex_);
  if (state_ != State::off) {
    leave(State::off);
  }
}

void Link::done() {
  const std::lock_guard lock(mutex_);
  // A guard that is still answering reads "done" after the hello.
  if (state_ == State::asked || state_ == State::accepted) {
    send_packet(socket_.get(), {"done"});
  }
  guarded_.store(false);
  state_ = State::off;
}

}  // namespace spikeloop::guard
