#include "guard_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/core/priority.hpp"
#include "spikeloop/guard/guard_timer.hpp"

namespace spikeloop::launch {
namespace {

constexpr const char* kProgram = "spikeloop-guard";
/// More than the guard itself allows.
constexpr TimeNs kLongestEnd = 4 * kNsPerSecond;

[[noreturn]] void fail(const std::string& reason) {
  throw TransportError(with_code(Code::partner_failed, "cannot start '{}': {}", kProgram, reason));
}

struct Connection {
  Descriptor ours;
  Descriptor theirs;
};

Connection connect_pair() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
    fail(std::strerror(errno));
  }
  return {Descriptor{ends[0]}, Descriptor{ends[1]}};
}

/// In the forked process: becomes the guard, or says why not.
[[noreturn]] void become(const ScratchFolder& scratch, int connection,
                         const std::map<std::string, std::string>& environment) {
  // Our terminal's Ctrl-C and hang-up are not for it.
  setsid();
  // Once more, so that it is nobody's child.
  if (const pid_t pid = fork(); pid != 0) {
    guard::send_packet(connection, {"started", {{"pid", fmt::to_string(pid)}}});
    _exit(0);
  }
  run_before_others();  // also while it is loaded: a busy machine must not delay it
  const int nowhere = open("/dev/null", O_RDWR);
  dup2(nowhere, 0);
  dup2(nowhere, 1);
  fcntl(connection, F_SETFD, 0);
  fcntl(scratch.descriptor(), F_SETFD, 0);  // the folder has its socket
  for (const auto& [name, value] : environment) {
    setenv(name.c_str(), value.c_str(), 1);
  }
  const std::string owner = std::to_string(connection);
  const std::string socket = guard_socket(scratch.path());
  execlp(kProgram, kProgram, "--socket", socket.c_str(), "--owner", owner.c_str(), nullptr);
  guard::send_packet(connection, {"log", {{"text", std::strerror(errno)}}});
  _exit(127);
}

void start(const ScratchFolder& scratch, int connection,
           const std::map<std::string, std::string>& environment) {
  const pid_t pid = fork();
  if (pid == 0) {
    become(scratch, connection, environment);
  }
  if (pid < 0) {
    fail(std::strerror(errno));
  }
  waitpid(pid, nullptr, 0);
}

}  // namespace

std::string guard_socket(const std::string& scratch) {
  return scratch + "/guard";
}

GuardProcess::GuardProcess(const ScratchFolder& scratch,
                           const std::map<std::string, std::string>& environment, Events events,
                           TimeNs longest)
    : events_(std::move(events)) {
  Connection connection = connect_pair();
  start(scratch, connection.theirs.get(), environment);
  connection_ = std::move(connection.ours);
  connection.theirs.reset();
  await_listening(longest);
  read();  // its process id may arrive after "listening"
}

void GuardProcess::await_listening(TimeNs longest) {
  const TimeNs deadline = wall_now() + longest;
  while (guard::wait_readable(connection_.get(), deadline - wall_now())) {
    const guard::Received news = guard::receive_packet(connection_.get());
    const std::string type = news.packet.type;
    if (type == "listening") {
      return;
    }
    if (news.closed || type == "log") {
      fail(news.closed ? "it ended before it listened" : guard::text_of(news.packet, "text"));
    }
    take(news.packet);
  }
  kill();
  fail(with_code(Code::partner_failed, "it does not listen within {}", format_time(longest)));
}

GuardProcess::~GuardProcess() {
  end();
}

bool GuardProcess::read() {
  while (connection_.get() >= 0) {
    const guard::Received news = guard::receive_packet(connection_.get());
    if (news.nothing) {
      return true;
    }
    if (news.closed) {
      connection_.reset();
      break;
    }
    take(news.packet);
  }
  return false;
}

bool GuardProcess::hangs() const {
  return wall_now() - heard_ > 2 * guard::kGuardSilence;
}

void GuardProcess::take(const guard::Packet& packet) {
  heard_ = wall_now();
  const std::string type = packet.type;
  if (type == "started") {
    pid_ = static_cast<pid_t>(guard::integer_of(packet, "pid").value_or(0));
  } else if (type == "log") {
    const bool plain = guard::text_of(packet, "level") == "info";
    events_.log(plain ? log::Level::info : log::Level::warning, guard::text_of(packet, "text"));
  } else if (type == "stopped") {
    events_.stopped();
  }
}

void GuardProcess::end() {
  if (connection_.get() < 0) {
    return;
  }
  shutdown(connection_.get(), SHUT_WR);
  const TimeNs deadline = wall_now() + kLongestEnd;
  while (read() && guard::wait_readable(connection_.get(), deadline - wall_now())) {
  }
  kill();
}

void GuardProcess::kill() {
  // As long as it has its end of the connection, the number is still its own.
  if (connection_.get() >= 0 && pid_ > 1) {
    ::kill(pid_, SIGKILL);
  }
  connection_.reset();
}

}  // namespace spikeloop::launch
