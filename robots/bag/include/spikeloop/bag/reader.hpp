// Reads the messages of a ROS 1 bag: one that recorder.hpp wrote, or anyone's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::bag {

struct Connection {
  std::string topic;
  std::string type;
  std::string md5;
  std::string node;  ///< of a run; empty in any other bag
};

struct Message {
  TimeNs time = 0;                   ///< since the bag begins; of a run's bag: simulated
  std::span<const std::byte> bytes;  ///< until the next one is asked for
};

/// The messages that one node takes from a bag, one after the other.
class Stream {
 public:
  ~Stream();
  Stream(Stream&&) noexcept;
  Stream& operator=(Stream&&) noexcept;

  /// None: there are no more. @throws FileError when the bag is damaged.
  std::optional<Message> next();

 private:
  friend class Reader;
  struct Impl;
  explicit Stream(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

class Reader {
 public:
  /// Reads the index. @throws FileError: no such file, no ROS 1 bag, without index, damaged.
  explicit Reader(const std::string& path);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Whether a run left it, so that its times are simulated ones.
  bool is_of_a_run() const;
  const std::vector<Connection>& connections() const;
  /// Of the last message of all.
  TimeNs end() const;
  /// Of the last message of a topic; none: it has no message.
  std::optional<TimeNs> end_of(const std::string& topic) const;

  /// Of a run: what `node` took, or, when it was another experiment's, one node's messages of the
  /// topic; of any other bag: all messages of the topic. May outlive the reader.
  Stream stream(const std::string& topic, const std::string& node) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::bag
