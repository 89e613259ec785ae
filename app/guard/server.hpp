// The guard's main thread: takes adapters in, and knows when it is no longer needed.
#pragma once

#include <signal.h>

#include <list>
#include <memory>

#include "guarded_robot.hpp"
#include "robots.hpp"
#include "spikeloop/status/signal_watch.hpp"

namespace spikeloop::guard {

/// A socket that is bound to a path, and removed with its owner.
class Listener {
 public:
  /// Takes the place of a socket that nobody listens at. @throws FileError
  explicit Listener(const std::string& path);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int fd() const { return socket_.get(); }
  /// The next adapter that waits; empty when there is none.
  Descriptor accept() const;

 private:
  std::string path_;
  Descriptor socket_;
};

class Server {
 public:
  /// Blocks the signals that stop it; so before any thread is started. @throws FileError
  /// @param owner socket to the launcher; -1 if no launcher has started the guard
  Server(const std::string& path, int owner);

  /// Until it is told to stop, or its owner has gone and no adapter needs it. Robots that are just
  /// being stopped get the rest of their zeros in the destructor.
  void run();

 private:
  void turn();
  void take_in();
  void wake() const;
  /// Reports to the launcher that this robot has been stopped.
  void report(const Hello& hello) const;
  bool owner_gone() const;

  Listener listener_;
  status::SignalWatch signals_;  ///< before any thread: they inherit that it holds signals back
  Descriptor wakeup_;
  int owner_;
  Robots robots_;
  std::list<GuardedRobot> guarded_;
};

}  // namespace spikeloop::guard
