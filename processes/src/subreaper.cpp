#include "subreaper.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <set>
#include <vector>

#include "reset_signals.hpp"
#include "spikeloop/processes/descendants.hpp"

namespace spikeloop {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kGrace{1000};
/// A process in uninterruptible sleep cannot be killed: then we give up.
constexpr std::chrono::seconds kPatience{10};
constexpr int kLookEveryMs = 20;

/// The standard ones lead nowhere from here on.
void close_all_but(const std::vector<int>& kept) {
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int fd = 0; fd <= 2; ++fd) {
    dup2(nowhere, fd);
  }
  const int last = std::max(2, *std::max_element(kept.begin(), kept.end()));
  for (int fd = 3; fd < last; ++fd) {
    if (std::find(kept.begin(), kept.end(), fd) == kept.end()) {
      close(fd);
    }
  }
  closefrom(last + 1);
}

/// In the forked child: becomes the program, or returns when it cannot.
void become(const ProgramStart& start, const SubreaperFiles& files, pid_t subreaper) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != subreaper) {
    _exit(143);
  }
  dup2(files.out, 1);
  dup2(files.err, 2);
  if (!start.directory.empty() && chdir(start.directory.c_str()) != 0) {
    return;
  }
  for (const auto& [name, value] : start.environment) {
    setenv(name.c_str(), value.c_str(), 1);
  }
  std::vector<char*> arguments;
  arguments.reserve(start.arguments.size() + 1);
  for (const auto& argument : start.arguments) {
    arguments.push_back(const_cast<char*>(argument.c_str()));
  }
  arguments.push_back(nullptr);
  reset_signals();
  execvp(arguments[0], arguments.data());
}

class Subreaper {
 public:
  Subreaper(const ProgramStart& start, const SubreaperFiles& files) : start_(start), files_(files) {
    sigset_t every;
    sigfillset(&every);
    sigprocmask(SIG_SETMASK, &every, nullptr);
    sigset_t child;
    sigemptyset(&child);
    sigaddset(&child, SIGCHLD);
    signals_ = signalfd(-1, &child, SFD_CLOEXEC | SFD_NONBLOCK);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    prctl(PR_SET_NAME, kSubreaperName);
  }

  void run() {
    if (!start_program()) {
      return;
    }
    while (true) {
      wait_for_news();
      reap();
      obey();
      if (ending_ && (end_some() || Clock::now() - ending_since_ > kPatience)) {
        break;
      }
    }
    reap();  // those that have ended since we looked: none of them is left as a zombie
  }

 private:
  void tell(SubreaperNews::Kind kind, int value) const {
    const SubreaperNews news{kind, value};
    send(files_.owner, &news, sizeof news, MSG_NOSIGNAL);
  }

  bool start_program() {
    int failure[2];
    if (pipe2(failure, O_CLOEXEC) != 0) {
      tell(SubreaperNews::Kind::cannot_start, errno);
      return false;
    }
    const pid_t subreaper = getpid();
    program_ = fork();
    if (program_ == 0) {
      become(start_, files_, subreaper);
      const int reason = errno;
      [[maybe_unused]] const auto written = write(failure[1], &reason, sizeof reason);
      _exit(127);
    }
    close(failure[1]);
    close(files_.out);
    close(files_.err);
    int reason = 0;
    const bool failed = program_ < 0 || read(failure[0], &reason, sizeof reason) == sizeof reason;
    close(failure[0]);
    tell(failed ? SubreaperNews::Kind::cannot_start : SubreaperNews::Kind::started,
         failed ? reason : program_);
    return !failed;
  }

  void wait_for_news() const {
    pollfd files[2] = {{signals_, POLLIN, 0}, {orphaned_ ? -1 : files_.owner, POLLIN, 0}};
    poll(files, 2, ending_ ? kLookEveryMs : -1);
    signalfd_siginfo ignored;
    while (read(signals_, &ignored, sizeof ignored) > 0) {
    }
  }

  void reap() {
    int status = 0;
    for (pid_t ended = waitpid(-1, &status, WNOHANG); ended > 0;
         ended = waitpid(-1, &status, WNOHANG)) {
      if (ended == program_) {
        tell(SubreaperNews::Kind::ended, status);
        begin_ending();
      }
    }
  }

  void obey() {
    char command = 0;
    while (!orphaned_) {
      const auto size = recv(files_.owner, &command, 1, MSG_DONTWAIT);
      if (size < 0 && (errno == EAGAIN || errno == EINTR)) {
        return;
      }
      orphaned_ = size <= 0;
      begin_ending();
      killing_ = killing_ || (size > 0 && command == kKillTree);
    }
  }

  void begin_ending() {
    if (!ending_) {
      ending_ = true;
      ending_since_ = Clock::now();
      ask_to_end(descendants(getpid()));
    }
  }

  /// Each process once: one that is told twice may take it for impatience.
  void ask_to_end(const std::vector<pid_t>& processes) {
    for (const pid_t process : processes) {
      if (asked_.insert(process).second) {
        ::kill(process, SIGTERM);
        ::kill(process, SIGCONT);
      }
    }
  }

  /// Returns whether nothing is left.
  bool end_some() {
    const auto left = descendants(getpid());
    // mpirun may have been about to start some.
    ask_to_end(left);
    if (killing_ || Clock::now() - ending_since_ > kGrace) {
      for (const pid_t process : left) {
        ::kill(process, SIGKILL);
      }
    }
    return left.empty();
  }

  const ProgramStart& start_;
  SubreaperFiles files_;
  int signals_ = -1;
  pid_t program_ = -1;
  bool orphaned_ = false;
  bool ending_ = false;
  bool killing_ = false;
  std::set<pid_t> asked_;
  Clock::time_point ending_since_{};
};

}  // namespace

void keep(const ProgramStart& start, const SubreaperFiles& files) {
  setpgid(0, 0);
  close_all_but({files.owner, files.out, files.err, start.kept});
  Subreaper(start, files).run();
  _exit(0);
}

}  // namespace spikeloop
