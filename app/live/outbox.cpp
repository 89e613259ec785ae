#include "outbox.hpp"

#include <utility>

namespace spikeloop::view {
namespace {

constexpr std::size_t kMostWaitingBytes = std::size_t{16} << 20;
constexpr std::size_t kMostWaitingFrames = std::size_t{1} << 16;

}  // namespace

bool Outbox::exceeds(std::size_t bytes, std::size_t frames) const {
  return bytes_ > bytes || queue_.size() > frames;
}

void Outbox::push(Outgoing outgoing) {
  std::deque<Outgoing> removed;  // destroyed without the lock
  const std::lock_guard lock(mutex_);
  bytes_ += outgoing.frame ? outgoing.frame->bytes.size() : 0;
  queue_.push_back(std::move(outgoing));
  if (exceeds(kMostWaitingBytes, kMostWaitingFrames)) {
    removed.swap(queue_);
    bytes_ = 0;
    for (const Outgoing& each : removed) {
      if (each.frame && each.frame->kind == Frame::Kind::data) {
        ++dropped_;
      } else {
        bytes_ += each.frame ? each.frame->bytes.size() : 0;
        queue_.push_back(each);
      }
    }
    // Half of the room, so that the queue is seldom searched.
    closed_ = closed_ || exceeds(kMostWaitingBytes / 2, kMostWaitingFrames / 2);
  }
  frames_ = queue_.size();
}

std::optional<Outgoing> Outbox::pop() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || queue_.empty()) {
    return std::nullopt;
  }
  Outgoing outgoing = std::move(queue_.front());
  queue_.pop_front();
  bytes_ -= outgoing.frame ? outgoing.frame->bytes.size() : 0;
  frames_ = queue_.size();
  return outgoing;
}

}  // namespace spikeloop::view
