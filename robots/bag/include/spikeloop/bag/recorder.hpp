// Writes the messages of a run to an MCAP file (https://mcap.dev), off the loop's thread.
//
// A message has the simulated time of the tick at which a node took or sent it. Every node has a
// channel of its own, whose metadata have its name in spikeloop_node: by it a reader knows that
// times are simulated, and whose message it was.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/core/write_failures.hpp"
#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::bag {

/// The entry of a channel's metadata with the node's name.
inline constexpr const char* kNodeField = "spikeloop_node";

struct Topic {
  std::string name;  ///< "/scan"
  std::string type;  ///< "sensor_msgs/LaserScan", or a .msg file
  std::string node;  ///< that takes or sends its messages
  messages::Dialect dialect = messages::Dialect::ros1;
};

/// Messages of any kind, for add_channel().
struct Channel {
  std::string topic;
  messages::Schema schema;
  std::string node;  ///< as of a Topic
};

struct RecorderOptions {
  /// Of messages that wait for the writer; one always finds room.
  std::size_t capacity_bytes = std::size_t{32} << 20;
  /// The loop waits for the writer in place of dropping: for runs that no clock hurries.
  bool patient = false;
  /// Receives the first failed write. nullptr: only the report of close() has it.
  WriteFailures* failures = nullptr;
};

/// What became of everything that was taken.
struct Report {
  std::uint64_t written = 0;
  std::uint64_t dropped = 0;
  std::string error;  ///< one sentence; empty when the file could be written
};

/// One file and its writer thread. A full buffer or a full disk never holds up the loop, unless it
/// is patient; what is lost is counted. A process that is killed leaves a file that is readable,
/// but for its last half second.
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
  std::uint32_t add_channel(const Channel& channel);
  /// A file within the file.
  void attach(const std::string& name, const std::string& media_type, std::string contents);
  /// Copies one message. Those of a time stay in the order in which they came.
  void take(std::uint32_t connection, TimeNs simulated, std::span<const std::byte> message);
  /// Writes what waits and closes the file. Whatever is taken later is counted as dropped. A second
  /// call gives the same report. Never throws.
  Report close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::bag
