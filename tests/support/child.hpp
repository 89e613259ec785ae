// Runs a command with a deadline: captures its output, and leaves no process behind, not even one
// that has moved to a session or process group of its own (mpirun's children do).
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace spikeloop::test {

struct Command {
  /// The program (searched in PATH) and its arguments.
  std::vector<std::string> arguments{};
  /// Then the whole family gets SIGKILL.
  std::chrono::milliseconds timeout{60'000};
  /// Added to ours; an empty value removes the name.
  std::map<std::string, std::string> environment{};
  /// Empty: ours.
  std::string directory{};
};

struct Outcome {
  int exit_code = -1;  ///< 128 + n when it died of signal n, as a shell says it; -1: timed out
  bool timed_out = false;
  std::string out;      ///< standard output
  std::string err;      ///< standard error
  int left_behind = 0;  ///< processes of its family that outlived it by 3 s and were killed
  double seconds = 0;

  std::string text() const { return out + err; }
  bool says(std::string_view words) const { return text().find(words) != std::string::npos; }
};

/// A running command. Its destructor kills the family.
class Child {
 public:
  explicit Child(const Command& command) : timeout_(command.timeout) {
    static std::atomic<unsigned> count{0};
    mark_ = "SPIKELOOP_TEST_FAMILY=" + std::to_string(getpid()) + "." + std::to_string(++count);
    begin_ = std::chrono::steady_clock::now();
    start(command);
  }
  ~Child() {
    if (!gone_) {
      kill_family();
    }
    if (!reaped_) {
      ::waitpid(pid_, nullptr, 0);
    }
    close_pipe(out_);
    close_pipe(err_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const { ::kill(pid_, number); }
  /// What it has printed so far: standard output and standard error.
  std::string output() {
    read_some(0);
    return outcome_.text();
  }
  /// False when it ended, or the time passed, without these words.
  bool wait_for(std::string_view words, std::chrono::milliseconds limit) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (output().find(words) == std::string::npos) {
      if (try_reap()) {
        return output().find(words) != std::string::npos;
      }
      if (std::chrono::steady_clock::now() > end) {
        return false;
      }
      read_some(5);
    }
    return true;
  }
  /// Waits for its end or its deadline, counted from its start.
  Outcome wait() {
    while (!try_reap()) {
      if (std::chrono::steady_clock::now() - begin_ > timeout_) {
        outcome_.timed_out = true;
        kill_family();
        ::waitpid(pid_, nullptr, 0);
        reaped_ = true;
        break;
      }
      read_some(5);
    }
    outcome_.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    await_family();
    read_some(0);
    return outcome_;
  }
  /// Process ids of everything alive that it started.
  std::vector<pid_t> family() const {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const std::string name = entry.path().filename();
      if (name.find_first_not_of("0123456789") != std::string::npos) {
        continue;
      }
      std::ifstream file(entry.path() / "environ", std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      const std::string whole = mark_ + '\0';
      if (text.find(whole) != std::string::npos) {
        found.push_back(static_cast<pid_t>(std::stol(name)));
      }
    }
    return found;
  }

 private:
  static void close_pipe(int& file) {
    if (file >= 0) {
      ::close(file);
      file = -1;
    }
  }

  std::vector<std::string> environment(const Command& command) const {
    std::vector<std::string> result{mark_};
    for (char** entry = environ; *entry != nullptr; ++entry) {
      const std::string text = *entry;
      const std::string name = text.substr(0, text.find('='));
      if (name != "SPIKELOOP_TEST_FAMILY" && !command.environment.contains(name)) {
        result.push_back(text);
      }
    }
    for (const auto& [name, value] : command.environment) {
      if (!value.empty()) {
        result.push_back(name + "=" + value);
      }
    }
    return result;
  }

  static std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> result;
    for (auto& text : texts) {
      result.push_back(text.data());
    }
    result.push_back(nullptr);
    return result;
  }

  void start(const Command& command) {
    auto arguments = command.arguments;
    auto variables = environment(command);
    const auto argv = pointers(arguments);
    const auto envp = pointers(variables);
    int out[2];
    int err[2];
    if (::pipe2(out, O_CLOEXEC) != 0 || ::pipe2(err, O_CLOEXEC) != 0) {
      throw std::runtime_error("cannot make a pipe");
    }
    pid_ = ::fork();
    if (pid_ == 0) {
      ::setpgid(0, 0);
      ::dup2(out[1], 1);
      ::dup2(err[1], 2);
      ::close(0);
      ::open("/dev/null", O_RDONLY);
      if (command.directory.empty() || ::chdir(command.directory.c_str()) == 0) {
        ::execvpe(argv[0], argv.data(), envp.data());
      }
      const std::string message = std::string("cannot start ") + argv[0] + "\n";
      [[maybe_unused]] const auto written = ::write(2, message.data(), message.size());
      ::_exit(127);
    }
    ::close(out[1]);
    ::close(err[1]);
    out_ = out[0];
    err_ = err[0];
    ::fcntl(out_, F_SETFL, O_NONBLOCK);
    ::fcntl(err_, F_SETFL, O_NONBLOCK);
  }

  bool try_reap() {
    int status = 0;
    if (!reaped_ && ::waitpid(pid_, &status, WNOHANG) == pid_) {
      reaped_ = true;
      outcome_.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return reaped_;
  }

  void drain(int& file, std::string& into) {
    char buffer[65536];
    for (;;) {
      const auto count = file < 0 ? -1 : ::read(file, buffer, sizeof buffer);
      if (count > 0) {
        into.append(buffer, static_cast<std::size_t>(count));
      } else {
        if (count == 0) {
          close_pipe(file);
        }
        return;
      }
    }
  }

  void read_some(int milliseconds) {
    pollfd files[2] = {{out_, POLLIN, 0}, {err_, POLLIN, 0}};
    if (milliseconds > 0) {
      ::poll(files, 2, milliseconds);  // sleeps when both are closed
    }
    drain(out_, outcome_.out);
    drain(err_, outcome_.err);
  }

  void kill_family() const {
    if (!reaped_) {
      ::kill(pid_, SIGKILL);  // it may not have become the command yet, and lacks the mark then
    }
    for (int round = 0; round < 50; ++round) {
      const auto alive = family();
      if (alive.empty()) {
        return;
      }
      for (const auto process : alive) {
        ::kill(process, SIGKILL);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  /// Members that mpirun is just ending are given 3 s; what is left then is counted and killed.
  void await_family() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
    auto alive = family();
    // A process that is just becoming another program has no environment, and so no mark: nobody is
    // gone before nobody has been there twice.
    for (int empty = alive.empty() ? 1 : 0; empty < 2 && std::chrono::steady_clock::now() < end;) {
      read_some(20);
      alive = family();
      empty = alive.empty() ? empty + 1 : 0;
    }
    outcome_.left_behind = static_cast<int>(alive.size());
    if (!alive.empty()) {
      kill_family();
    }
    gone_ = true;
  }

  std::chrono::milliseconds timeout_;
  std::chrono::steady_clock::time_point begin_;
  std::string mark_;
  pid_t pid_ = -1;
  int out_ = -1;
  int err_ = -1;
  bool reaped_ = false;
  bool gone_ = false;  ///< its family, too
  Outcome outcome_;
};

/// Runs a command to its end.
inline Outcome run(const Command& command) {
  return Child(command).wait();
}

}  // namespace spikeloop::test
