// A file of messages, whatever its format.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/bag/reader.hpp"

namespace spikeloop::bag {

/// Gives messages in the order of their times.
struct Stream::Impl {
  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  virtual ~Impl() = default;
  virtual std::optional<Message> next() = 0;
};

class Source {
 public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  const std::vector<Connection>& connections() const { return connections_; }
  bool is_of_a_run() const { return of_a_run_; }
  TimeNs end() const { return end_; }
  virtual std::optional<TimeNs> end_of(const std::string& topic) = 0;
  /// All messages of these connections. May outlive the source's last user.
  virtual std::unique_ptr<Stream::Impl> stream(std::vector<std::size_t> connections) = 0;

 protected:
  std::vector<Connection> connections_;  ///< that have messages
  bool of_a_run_ = false;
  TimeNs end_ = 0;
};

/// @throws FileError as Reader.
std::shared_ptr<Source> open_ros1_bag(const std::string& path);
std::shared_ptr<Source> open_mcap(const std::string& path);

}  // namespace spikeloop::bag
