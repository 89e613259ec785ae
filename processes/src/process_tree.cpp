#include "spikeloop/processes/process_tree.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/processes/descendants.hpp"
#include "subreaper.hpp"

namespace spikeloop {
namespace {

using Clock = std::chrono::steady_clock;
/// mpirun that is terminated needs up to two seconds for its programs.
constexpr std::chrono::seconds kGraceWithoutSubreaper{5};

struct Pair {
  Descriptor ours;
  Descriptor theirs;
};

[[noreturn]] void fail(const ProgramStart& start, int reason) {
  throw TransportError(with_code(Code::program, "cannot start '{}': {}", start.arguments.at(0),
                                 std::strerror(reason)));
}

Pair make_pipe(const ProgramStart& start) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    fail(start, errno);
  }
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return {Descriptor{ends[0]}, Descriptor{ends[1]}};
}

Pair make_socket_pair(const ProgramStart& start) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
    fail(start, errno);
  }
  return {Descriptor{ends[0]}, Descriptor{ends[1]}};
}

SubreaperNews first_news(int subreaper) {
  SubreaperNews news{SubreaperNews::Kind::cannot_start, ECHILD};
  while (recv(subreaper, &news, sizeof news, 0) < 0 && errno == EINTR) {
  }
  return news;
}

}  // namespace

ProcessTree::ProcessTree(const ProgramStart& start) {
  Pair subreaper = make_socket_pair(start);
  Pair out = make_pipe(start);
  Pair err = make_pipe(start);
  subreaper_pid_ = fork();
  if (subreaper_pid_ == 0) {
    keep(start, {subreaper.theirs.get(), out.theirs.get(), err.theirs.get()});
  }
  if (subreaper_pid_ < 0) {
    fail(start, errno);
  }
  subreaper.theirs.reset();
  const SubreaperNews news = first_news(subreaper.ours.get());
  if (news.kind != SubreaperNews::Kind::started) {
    waitpid(subreaper_pid_, nullptr, 0);
    fail(start, news.value);
  }
  pid_ = news.value;
  program_ = Descriptor{static_cast<int>(syscall(SYS_pidfd_open, pid_, 0))};
  subreaper_ = std::move(subreaper.ours);
  out_ = std::move(out.ours);
  err_ = std::move(err.ours);
}

ProcessTree::~ProcessTree() {
  order(kKillTree);
  while (!gone()) {
    pollfd waiting{fd(), POLLIN, 0};
    poll(&waiting, 1, 100);  // a program without its subreaper is killed after a while
  }
}

void ProcessTree::signal(int number) const {
  if (!status_) {
    ::kill(pid_, number);
  }
}

void ProcessTree::signal_all(int number) const {
  signal(number);
  for (const pid_t process : descendants(pid_)) {
    ::kill(process, number);
  }
}

void ProcessTree::order(char command) {
  killing_ = killing_ || command == kKillTree;
  if (subreaper_.get() >= 0) {
    send(subreaper_.get(), &command, 1, MSG_NOSIGNAL);
    ::kill(subreaper_pid_, SIGCONT);  // one that was stopped would not obey
  } else {
    signal(command == kKillTree ? SIGKILL : SIGTERM);
  }
}

void ProcessTree::end() {
  order(kEndTree);
}

void ProcessTree::kill() {
  order(kKillTree);
}

bool ProcessTree::gone() {
  while (subreaper_.get() >= 0) {
    SubreaperNews news{};
    const auto size = recv(subreaper_.get(), &news, sizeof news, MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) {
      return false;
    }
    if (size > 0) {
      status_ = news.value;
    } else {
      subreaper_.reset();
      int status = 0;
      if (waitpid(subreaper_pid_, &status, 0) > 0 && WIFSIGNALED(status) && !status_) {
        subreaper_killed_by_ = WTERMSIG(status);
      }
      subreaper_ended_ = Clock::now();
      signal(SIGCONT);  // one that is stopped would not end
    }
  }
  return status_ || program_ended();
}

bool ProcessTree::program_ended() {
  // Without a pidfd it had ended before we could open one, or the system has none.
  pollfd file{program_.get(), POLLIN, 0};
  const bool ended = program_.get() < 0 ? ::kill(pid_, 0) != 0 : poll(&file, 1, 0) > 0;
  const auto waited = Clock::now() - subreaper_ended_;
  // A process in uninterruptible sleep cannot be killed: then we give up.
  if (ended || waited > 2 * kGraceWithoutSubreaper) {
    status_ = SIGTERM;
    return true;
  }
  if (killing_ || waited > kGraceWithoutSubreaper) {
    for (const pid_t process : descendants(pid_)) {
      ::kill(process, SIGKILL);
    }
    signal(SIGKILL);
  }
  return false;
}

int exit_code(int wait_status) {
  return WIFSIGNALED(wait_status) ? 128 + WTERMSIG(wait_status) : WEXITSTATUS(wait_status);
}

std::string stopped_by(int signal) {
  return signal == SIGINT ? "stopped by Ctrl-C"
                          : fmt::format("stopped by signal {} ({})", signal, strsignal(signal));
}

}  // namespace spikeloop
