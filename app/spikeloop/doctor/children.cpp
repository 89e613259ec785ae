#include "children.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>

#include "spikeloop/core/error.hpp"

namespace spikeloop::app::doctor {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::size_t kMostOutput = 1'000'000;
constexpr int kCannotStart = 127;

/// Takes what stands in the pipe; what is beyond the limit is left out.
void drain(int fd, std::string& text) {
  char buffer[4096];
  for (auto size = read(fd, buffer, sizeof buffer); size > 0 || (size < 0 && errno == EINTR);
       size = read(fd, buffer, sizeof buffer)) {
    if (size > 0 && text.size() < kMostOutput) {
      text.append(buffer, static_cast<std::size_t>(size));
    }
  }
}

class Child {
 public:
  Child(const launch::ProgramStart& start, Answer& answer) : answer_(answer) {
    try {
      tree_ = std::make_unique<launch::ProcessTree>(start);
    } catch (const Error& error) {
      answer_.exit_code = kCannotStart;
      answer_.err = error.what();
    }
  }

  bool running() const { return tree_ != nullptr && !ended_; }
  int fd() const { return tree_->fd(); }
  /// Its pipes are read at every look: a full one would hold it up.
  void look(double seconds) {
    const bool gone = tree_->gone();
    drain(tree_->out(), answer_.out);
    drain(tree_->err(), answer_.err);
    ended_ = gone || tree_->status().has_value();
    answer_.seconds = seconds;
    if (ended_) {
      take_status(tree_->status().value_or(0));
    }
  }
  /// mpirun's own exit codes are above 128: they are no signals.
  void take_status(int status) {
    answer_.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    answer_.exit_code = WIFSIGNALED(status) ? 0 : WEXITSTATUS(status);
  }
  void give_up() {
    answer_.in_time = false;
    tree_->kill();
  }

 private:
  Answer& answer_;
  std::unique_ptr<launch::ProcessTree> tree_;
  bool ended_ = false;
};

}  // namespace

std::string_view first_line(std::string_view text) {
  return text.substr(0, text.find('\n'));
}

std::string_view last_line(std::string_view text) {
  text = text.substr(0, text.find_last_not_of(" \r\n") + 1);
  return text.substr(text.rfind('\n') + 1);
}

std::string Answer::failure() const {
  if (!in_time) {
    return fmt::format("no answer within {:.0f} s", seconds);
  }
  if (signal != 0) {
    return fmt::format("it crashed ({})", strsignal(signal));
  }
  const std::string_view said = last_line(last_line(err).empty() ? out : err);
  if (exit_code == kCannotStart && !said.empty()) {
    return std::string(said);
  }
  return exit_code == 0
             ? ""
             : fmt::format("exit code {}{}{}", exit_code, said.empty() ? "" : ": ", said);
}

std::vector<Answer> ask(const std::vector<launch::ProgramStart>& starts, milliseconds patience) {
  constexpr int kLookEveryMs = 20;
  const auto begin = Clock::now();
  const auto seconds = [begin] {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  std::vector<Answer> answers(starts.size());
  std::vector<std::unique_ptr<Child>> children;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    children.push_back(std::make_unique<Child>(starts[i], answers[i]));
  }
  const auto running = [](const auto& child) { return child->running(); };
  while (std::ranges::any_of(children, running) && Clock::now() < begin + patience) {
    std::vector<pollfd> files;
    for (const auto& child : children) {
      if (child->running()) {
        files.push_back({child->fd(), POLLIN, 0});
      }
    }
    poll(files.data(), files.size(), kLookEveryMs);
    for (const auto& child : children) {
      if (child->running()) {
        child->look(seconds());
      }
    }
  }
  for (const auto& child : children) {  // all at once: the end of a child waits for its processes
    if (child->running()) {
      child->give_up();
    }
  }
  return answers;
}

}  // namespace spikeloop::app::doctor
