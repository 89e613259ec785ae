// Data that Backend and the thread of the connections exchange for one client.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace spikeloop::view {

/// Bytes of a message, or of an HTTP response. Shared by all viewers that receive it.
struct Frame {
  enum class Kind { text, data, time, raw };
  Frame(Kind frame_kind, std::string content) : kind(frame_kind), bytes(std::move(content)) {}
  const Kind kind;
  const std::string bytes;
};
using SharedFrame = std::shared_ptr<const Frame>;

struct Outgoing {
  SharedFrame frame;               ///< Empty: the end of an HTTP response
  std::uint32_t subscription = 0;  ///< subscription number of a data frame
};

/// Frames that wait for one client. The thread of the data pushes, the thread of the connections
/// pops and never waits for the other thread.
class Outbox {
 public:
  /// When more than 16 MB or 65,536 frames wait, all data frames are dropped and counted. If more
  /// than half of that still waits, the client is closed.
  void push(Outgoing outgoing);
  /// nullopt if no frame waits, or if the other thread holds the lock.
  std::optional<Outgoing> pop();

  bool is_empty() const { return frames_ == 0; }
  std::size_t bytes() const { return bytes_; }
  std::uint64_t dropped() const { return dropped_; }
  void close() { closed_ = true; }
  bool is_closed() const { return closed_; }

 private:
  bool exceeds(std::size_t bytes, std::size_t frames) const;

  std::mutex mutex_;
  std::deque<Outgoing> queue_;
  std::atomic<std::size_t> frames_{0};
  std::atomic<std::size_t> bytes_{0};
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> closed_{false};
};

struct Client {
  explicit Client(bool has_token) : may_control(has_token) {}
  const bool may_control;
  Outbox outbox;
  std::atomic<unsigned> waiting_requests{0};
  std::atomic<bool> gone{false};  ///< True if the connection is closed
};
using SharedClient = std::shared_ptr<Client>;

}  // namespace spikeloop::view
