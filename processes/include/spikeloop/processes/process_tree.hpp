// A program and everything it starts, which never outlives us.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop {

/// Name of a subreaper in the list of processes.
inline constexpr const char* kSubreaperName = "spikeloop-keep";

struct ProgramStart {
  std::vector<std::string> arguments;              ///< the program, searched in PATH, and its own
  std::map<std::string, std::string> environment;  ///< added to ours
  std::string directory;                           ///< to run in; empty: ours
  /// A descriptor that the subreaper keeps open as long as it lives: ScratchFolder::descriptor();
  /// -1: none.
  int kept = -1;
};

/// Between us and the program stands a subreaper: a forked process that adopts whatever the tree
/// orphans, and that ends the tree when it is told to, when the program has ended, or when we have
/// died, by whatever signal. mpirun alone does not do this: it can hang, and when it is killed the
/// programs that have not reached MPI_Init live on.
///
/// The tree stands in process groups of its own, so Ctrl-C does not reach it.
class ProcessTree {
 public:
  /// @throws TransportError when the program cannot be started, with the reason.
  explicit ProcessTree(const ProgramStart& start);
  /// Kills what is left.
  ~ProcessTree();
  ProcessTree(const ProcessTree&) = delete;
  ProcessTree& operator=(const ProcessTree&) = delete;

  pid_t pid() const { return pid_; }
  /// The process between us and the program.
  pid_t subreaper() const { return subreaper_pid_; }
  /// Sends a signal to the program alone.
  void signal(int number) const;
  /// Sends a signal to every process of the tree, the program first.
  void signal_all(int number) const;
  /// SIGTERM to every process of the tree, SIGKILL to those left after one second.
  void end();
  /// SIGKILL to every process of the tree.
  void kill();

  /// Reads news of the subreaper; returns whether the tree, and not only the program, has gone.
  bool gone();
  /// The program's status as of waitpid, once it has ended; see exit_code(). SIGTERM when the
  /// subreaper was killed: the kernel then sends that to the program, whose own status is unknown.
  std::optional<int> status() const { return status_; }
  /// Signal that killed the subreaper while the program ran. nullopt: the subreaper was not killed.
  std::optional<int> subreaper_killed_by() const { return subreaper_killed_by_; }
  /// Readable when gone() may have changed. Call gone() ten times a second all the same: it kills a
  /// program that goes on without its subreaper.
  int fd() const { return subreaper_.get() >= 0 ? subreaper_.get() : program_.get(); }
  /// Its standard output and standard error; do not wait.
  int out() const { return out_.get(); }
  int err() const { return err_.get(); }

 private:
  void order(char command);
  /// After the subreaper: whether the program has ended; kills it when it does not end by SIGTERM.
  bool program_ended();

  pid_t pid_ = -1;
  pid_t subreaper_pid_ = -1;
  bool killing_ = false;
  std::optional<int> status_;
  std::optional<int> subreaper_killed_by_;
  Descriptor subreaper_;
  Descriptor program_;  ///< a pidfd: it is not our child
  std::chrono::steady_clock::time_point subreaper_ended_{};
  Descriptor out_;
  Descriptor err_;
};

/// As a shell says it: 128 + n after signal n.
int exit_code(int wait_status);

/// "stopped by Ctrl-C", "stopped by signal 15 (Terminated)".
std::string stopped_by(int signal);

}  // namespace spikeloop
