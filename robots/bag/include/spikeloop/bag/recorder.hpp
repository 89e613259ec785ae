// Writes the messages of a run to a ROS 1 bag (format 2.0), off the loop's thread.
//
// A message has the simulated time of the tick at which a node took or sent it. ROS knows no time
// 0, so that 0 is written as 1 ns. Every node has a connection of its own, whose header has the
// field spikeloop_node: by it a reader knows that times are simulated, and whose message it was.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "spikeloop/core/time.hpp"

namespace spikeloop::bag {

/// The connection header's field with the node's name.
inline constexpr const char* kNodeField = "spikeloop_node";

/// A bag's time of a simulated one, and back.
constexpr TimeNs stamp_of(TimeNs simulated) {
  return simulated < 1 ? 1 : simulated;
}
constexpr TimeNs simulated_of(TimeNs stamp) {
  return stamp <= 1 ? 0 : stamp;
}

struct Topic {
  std::string name;  ///< "/scan"
  std::string type;  ///< "sensor_msgs/LaserScan", of the built-in definitions
  std::string node;  ///< that takes or sends its messages
};

struct RecorderOptions {
  /// Of messages that wait for the writer; one always finds room.
  std::size_t capacity_bytes = std::size_t{32} << 20;
  /// The loop waits for the writer in place of dropping: for runs that no clock hurries.
  bool patient = false;
};

/// What became of everything that was taken.
struct Report {
  std::uint64_t written = 0;
  std::uint64_t dropped = 0;
  std::string error;  ///< one sentence; empty when the bag could be written
};

/// One bag and its writer thread. A full buffer or a full disk never holds up the loop, unless it
/// is patient; what is lost is counted. A process that is killed leaves a bag that `rosbag reindex`
/// makes readable, but for its last 64 KiB.
class Recorder {
 public:
  /// Makes the file, replacing one of the same name. @throws FileError when it cannot be made.
  explicit Recorder(const std::string& path, const RecorderOptions& options = {});
  /// Closes.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // These by one thread.

  /// A connection, for take(). @throws ConfigurationError for an unknown type.
  std::uint32_t add(const Topic& topic);
  /// Copies one message. Those of a time stay in the order in which they came.
  void take(std::uint32_t connection, TimeNs simulated, std::span<const std::byte> message);
  /// Writes what waits and closes the bag. Whatever is taken later is counted as dropped. A second
  /// call gives the same report. Never throws.
  Report close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::bag
