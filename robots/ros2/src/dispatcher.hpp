// The session's thread: it waits for conditions of DDS and does what belongs to them. Listeners of
// DDS would save some 15 us a message (benchmarks/ros2_latency.cpp), and hold up Cyclone's
// receiving thread, and with it every topic, while one message is being decoded.
#pragma once

#include <dds/dds.h>

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "spikeloop/topics/closable.hpp"

namespace spikeloop::ros2 {

class Dispatcher {
 public:
  using Ticket = dds_attach_t;

  explicit Dispatcher(dds_entity_t participant);
  ~Dispatcher();
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  /// Ends the thread: nothing is done any more.
  void stop();
  /// From now on `work` is done whenever `condition` holds; it has to end that. If several
  /// conditions hold, the one that was added first is served first: discovery, then messages.
  Ticket add(dds_entity_t condition, std::function<void()> work);
  /// Waits while the work is being done; it is not done any more afterwards.
  void remove(Ticket ticket, dds_entity_t condition);

 private:
  void run();
  std::shared_ptr<topics::Closable<>> find(Ticket ticket);

  dds_entity_t waitset_;
  dds_entity_t end_;  ///< a guard condition
  std::atomic<bool> ending_{false};
  std::mutex mutex_;
  Ticket last_ = 0;
  std::map<Ticket, std::shared_ptr<topics::Closable<>>> work_;
  std::thread thread_;
};

}  // namespace spikeloop::ros2
