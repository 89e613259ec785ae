#include "process_group.hpp"

#include <unistd.h>

namespace spikeloop::launch {
namespace {

/// Messages per turn, so that a flood does not delay signals and output.
constexpr int kMostMessages = 1000;

/// At most 1 MB, so that one program's output does not keep the others waiting. Returns false at
/// the end of the output.
bool read_output(int fd, TaggedOutput& output) {
  char buffer[65536];
  for (int i = 0; i < 16; ++i) {
    const auto size = ::read(fd, buffer, sizeof buffer);
    if (size <= 0) {
      return size < 0;
    }
    output.feed({buffer, static_cast<std::size_t>(size)});
  }
  return true;
}

}  // namespace

Process::Process(const ProgramStart& start, const TaggedOutput::Handler& handler)
    : handler_(handler),
      tree_(start),
      out_(false, [this](const OutputLine& line) { handle(line); }),
      err_(true, [this](const OutputLine& line) { handle(line); }) {}

void Process::handle(const OutputLine& line) {
  error_tail_.take(line);
  handler_(line);
}

void Process::read() {
  if (gone_) {
    return;
  }
  gone_ = tree_.gone();
  out_open_ = out_open_ && read_output(tree_.out(), out_);
  err_open_ = err_open_ && read_output(tree_.err(), err_);
  if (gone_) {
    out_.finish();
    err_.finish();
  }
}

Process& ProcessGroup::start(const ProgramStart& start, const TaggedOutput::Handler& handler) {
  processes_.push_back(std::make_unique<Process>(start, handler));
  return *processes_.back();
}

void Process::add_files(std::vector<pollfd>& files) const {
  if (!gone_) {
    files.push_back({tree_.fd(), POLLIN, 0});
    // A pipe that the program has closed would always be ready.
    files.push_back({out_open_ ? tree_.out() : -1, POLLIN, 0});
    files.push_back({err_open_ ? tree_.err() : -1, POLLIN, 0});
  }
}

void ProcessGroup::turn(Milliseconds most) {
  std::vector<pollfd> files{{receiver_.fd(), POLLIN, 0}, {signals_.fd(), POLLIN, 0}};
  for (const auto& process : processes_) {
    process->add_files(files);
  }
  poll(files.data(), files.size(), static_cast<int>(most.count()));
  for (const auto& process : processes_) {
    process->read();
  }
  pass_on_messages();
  pass_on_signals();
}

void ProcessGroup::pass_on_messages() {
  for (int i = 0; i < kMostMessages; ++i) {
    const auto message = receiver_.next(Milliseconds{0});
    if (!message) {
      return;
    }
    events_.message(*message);
  }
}

void ProcessGroup::pass_on_signals() {
  while (true) {
    const auto number = signals_.next();
    if (!number) {
      return;
    }
    events_.signal(*number);
  }
}

bool ProcessGroup::turn_until(const std::function<bool()>& condition, Milliseconds most) {
  const auto deadline = Clock::now() + most;
  while (!condition() && Clock::now() < deadline) {
    turn(Milliseconds{20});
  }
  return condition();
}

}  // namespace spikeloop::launch
