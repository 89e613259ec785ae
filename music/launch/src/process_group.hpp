// Every program that runs for a job, and one place to wait for news of all of them.
#pragma once

#include <poll.h>

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "error_tail.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/processes/process_tree.hpp"
#include "spikeloop/status/signal_watch.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::launch {

using Milliseconds = std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// A program with its output cut into lines.
class Process {
 public:
  Process(const ProgramStart& start, const TaggedOutput::Handler& handler);

  ProcessTree& tree() { return tree_; }
  const ProcessTree& tree() const { return tree_; }
  bool gone() const { return gone_; }
  /// Passes on what it has printed. When its tree has gone, unfinished lines too.
  void read();
  const std::string& error_tail() const { return error_tail_.text(); }
  /// What to poll for news of it.
  void add_files(std::vector<pollfd>& files) const;

 private:
  void handle(const OutputLine& line);

  TaggedOutput::Handler handler_;
  ProcessTree tree_;
  TaggedOutput out_;
  TaggedOutput err_;
  ErrorTail error_tail_;
  bool out_open_ = true;
  bool err_open_ = true;
  bool gone_ = false;
};

struct ProcessGroupEvents {
  std::function<void(const nlohmann::json&)> message;
  std::function<void(int)> signal;
};

class ProcessGroup {
 public:
  ProcessGroup(status::Receiver& receiver, ProcessGroupEvents events)
      : receiver_(receiver), events_(std::move(events)) {}

  /// @throws TransportError when it cannot be started.
  Process& start(const ProgramStart& start, const TaggedOutput::Handler& handler);
  /// Waits for news, at most so long, and passes all of it on.
  void turn(Milliseconds most);
  /// Turns until the condition holds or the time is over; returns the condition.
  bool turn_until(const std::function<bool()>& condition, Milliseconds most);

 private:
  void pass_on_messages();
  void pass_on_signals();

  status::Receiver& receiver_;
  ProcessGroupEvents events_;
  status::SignalWatch signals_{SIGTSTP};
  std::vector<std::unique_ptr<Process>> processes_;
};

}  // namespace spikeloop::launch
