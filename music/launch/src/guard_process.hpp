// spikeloop-guard beside a job: outside of every tree that a subreaper or mpirun ends.
#pragma once

#include <sys/types.h>

#include <functional>
#include <map>
#include <string>

#include "spikeloop/core/log.hpp"
#include "spikeloop/guard/protocol.hpp"
#include "spikeloop/processes/scratch_folder.hpp"

namespace spikeloop::launch {

/// Where the guard of a launcher with this scratch folder listens.
std::string guard_socket(const std::string& scratch);

/// A process in a session of its own, no child of ours, so that whatever kills this job at once
/// leaves it the time to stop the robot. It ends by itself when we have gone.
class GuardProcess {
 public:
  struct Events {
    std::function<void(log::Level, const std::string&)> log;
    /// The guard has stopped a robot, because its adapter had died.
    std::function<void()> stopped;
  };

  /// Waits until it listens at guard_socket() of the folder.
  /// @param environment added to ours; PATH says where it is
  /// @param longest wall time that the start may take
  /// @throws TransportError when it does not.
  GuardProcess(const ScratchFolder& scratch, const std::map<std::string, std::string>& environment,
               Events events, TimeNs longest);
  ~GuardProcess();
  GuardProcess(const GuardProcess&) = delete;
  GuardProcess& operator=(const GuardProcess&) = delete;

  /// Passes on what it has said. False when it has ended.
  bool read();
  /// True if it has sent nothing for kGuardSilence twice over.
  bool hangs() const;
  pid_t pid() const { return pid_; }
  /// Lets it end, and waits until it has; kills one that does not.
  void end();
  void kill();

 private:
  void await_listening(TimeNs longest);
  void take(const guard::Packet& packet);

  Events events_;
  Descriptor connection_;  ///< it has the other end, and nobody else
  pid_t pid_ = 0;
  TimeNs heard_ = 0;  ///< wall time of its newest packet
};

}  // namespace spikeloop::launch
