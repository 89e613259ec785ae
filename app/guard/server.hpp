// Main thread of the guard: accepts adapters, and ends when no adapter needs the guard.
#pragma once

#include <signal.h>

#include <list>
#include <string>

#include "guarded_robot.hpp"
#include "spikeloop/status/signal_watch.hpp"

namespace spikeloop::guard {

class Server {
 public:
  /// Blocks the signals that stop it; construct it before any thread is started. @throws FileError
  /// @param path path of the socket, which is removed in the end
  /// @param owner socket to the launcher; -1 if no launcher has started the guard
  Server(const std::string& path, int owner);

  /// Runs until a signal stops it, or its owner has ended and no adapter needs it. Robots that are
  /// being stopped receive their remaining stop commands in the destructor.
  void run();
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

 private:
  void turn();
  void take_in();
  void wake() const;
  /// Reports to the launcher that this robot has been stopped.
  void report(const Hello& hello) const;
  bool owner_gone() const;

  std::string path_;
  Descriptor listener_;
  status::SignalWatch signals_;  ///< before any thread, which inherits the signal mask
  Descriptor wakeup_;
  int owner_;
  Robots robots_;
  std::list<GuardedRobot> guarded_;
};

}  // namespace spikeloop::guard
