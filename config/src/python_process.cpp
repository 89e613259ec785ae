#include "python_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <thread>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

namespace fs = std::filesystem;

namespace {

constexpr std::array kEndingSignals{SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1};
constexpr std::chrono::milliseconds kLook{5};

// The package `spikeloop`: beside the programs, as installed and in the build tree, or in the
// sources.
std::string package() {
  std::error_code ignored;
  const fs::path programs = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const fs::path installed = programs.parent_path() / "share/spikeloop/python";
  return fs::exists(installed / "spikeloop") ? installed.string() : SPIKELOOP_PYTHON;
}

std::vector<std::string> environment() {
  std::vector<std::string> variables;
  std::string path = package();
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string variable = *entry;
    constexpr std::string_view kPath = "PYTHONPATH=";
    if (!variable.starts_with(kPath)) {
      variables.push_back(variable);
    } else if (variable.size() > kPath.size()) {
      path = variable.substr(kPath.size()) + ":" + path;  // what the user has put there goes first
    }
  }
  variables.push_back("PYTHONPATH=" + path);
  variables.push_back("PYTHONSAFEPATH=1");  // no module of the working directory's
  return variables;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> list;
  for (std::string& word : words) {
    list.push_back(word.data());
  }
  list.push_back(nullptr);
  return list;
}

// In the forked child, where nothing may be allocated: becomes the program, or tells why not.
[[noreturn]] void become(char* const* words, char* const* variables, const sigset_t& mask,
                         pid_t parent, int told) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() == parent) {
    dup2(STDERR_FILENO, STDOUT_FILENO);
    pthread_sigmask(SIG_SETMASK, &mask, nullptr);
    execvpe(words[0], words, variables);
    const int failure = errno;
    [[maybe_unused]] const auto written = write(told, &failure, sizeof failure);
  }
  _exit(127);
}

pid_t start(std::vector<std::string>& words, const HeldSignals& held) {
  std::vector<std::string> variables = environment();
  const std::vector<char*> arguments = pointers(words);
  const std::vector<char*> entries = pointers(variables);
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) {
    throw FileError("start", words[0], errno);
  }
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    become(arguments.data(), entries.data(), held.before(), parent, pipe[1]);
  }
  int failure = child < 0 ? errno : 0;
  close(pipe[1]);
  if (child > 0 && read(pipe[0], &failure, sizeof failure) > 0) {
    waitpid(child, nullptr, 0);
  }
  close(pipe[0]);
  if (failure != 0) {
    throw FileError("start", words[0], failure);
  }
  return child;
}

}  // namespace

HeldSignals::HeldSignals() {
  sigemptyset(&held_);
  pthread_sigmask(SIG_BLOCK, nullptr, &before_);
  for (const int number : kEndingSignals) {
    struct sigaction action {};
    if (sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_DFL &&
        sigismember(&before_, number) == 0) {
      sigaddset(&held_, number);
    }
  }
  pthread_sigmask(SIG_BLOCK, &held_, nullptr);
}

HeldSignals::~HeldSignals() {
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool HeldSignals::any() const {
  sigset_t pending;
  sigemptyset(&pending);
  sigpending(&pending);
  for (const int number : kEndingSignals) {
    if (sigismember(&held_, number) == 1 && sigismember(&pending, number) == 1) {
      return true;
    }
  }
  return false;
}

int run_python(std::vector<std::string> words, const HeldSignals& held) {
  const pid_t child = start(words, held);
  int status = 0;
  for (pid_t ended = 0; ended == 0 || (ended < 0 && errno == EINTR);) {
    if (held.any()) {
      kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(kLook);
    ended = waitpid(child, &status, WNOHANG);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace spikeloop
