// Reads the messages of a recording: MCAP files, those of recorder.hpp or of any other program,
// SQLite files of ROS 2, and bags of ROS 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/messages/definition.hpp"
#include "spikeloop/messages/recorded_type.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::bag {

struct Connection {
  std::string topic;
  std::string type;                            ///< PACKAGE/TYPE
  std::string encoding;                        ///< "ros1", "cdr", or another one
  std::optional<messages::Dialect> dialect{};  ///< of the encoding; none: sensors cannot take it
  std::string version{};      ///< md5 sum of ROS 1, type hash of ROS 2; empty if it is not known
  std::string node{};         ///< of a run; empty in any other recording
  messages::Schema schema{};  ///< as the file has it; empty if files of this kind have none
};

struct Message {
  TimeNs time = 0;                   ///< since the bag begins; of a run's bag: simulated
  std::span<const std::byte> bytes;  ///< until the next one is asked for
};

/// The messages that one node takes from a recording, one after the other.
class Stream {
 public:
  struct Impl;
  ~Stream();
  Stream(Stream&&) noexcept;
  Stream& operator=(Stream&&) noexcept;

  /// None: there are no more. @throws FileError when the file is damaged.
  std::optional<Message> next();

 private:
  friend class Reader;
  explicit Stream(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

class Recording;

class Reader {
 public:
  /// Finds all messages. `path` is a file, or a folder whose files are the parts of a recording.
  /// Of an MCAP file that was not ended, reads as much as possible, with a warning.
  /// @throws FileError: no such file, unknown format, damaged, a bag without index, a part is
  /// missing.
  explicit Reader(const std::string& path);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Whether a run left it, so that its times are simulated ones.
  bool is_of_a_run() const;
  const std::vector<Connection>& connections() const;
  /// Warnings about the files: cut off, parts that are left out, jumps of the clock.
  const std::vector<std::string>& warnings() const;
  /// ROS 2 when a connection is, but for spikes and signals.
  messages::Dialect dialect() const;
  /// Of the last message of all.
  TimeNs end() const;
  /// Of the last message of a topic; none: it has no message.
  std::optional<TimeNs> end_of(const std::string& topic) const;

  /// Of a run: what `node` took, or, when it was another experiment's, one node's messages of the
  /// topic; of any other recording: all messages of the topic. May outlive the reader.
  Stream stream(const std::string& topic, const std::string& node) const;

 private:
  std::shared_ptr<const Recording> recording_;
};

/// "/odom (nav_msgs/Odometry), /scan (sensor_msgs/LaserScan)"; "none" if there are no messages.
std::string list_topics(const Reader& reader);

/// Description of a topic for messages::compare_recorded() and messages::layout_of().
/// @param node as in Reader::stream()
messages::RecordedTopic recorded_topic(const Reader& reader, const Connection& connection,
                                       const std::string& node);

}  // namespace spikeloop::bag
