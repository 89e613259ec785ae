#include "connection.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "viewer.hpp"
#include "websocket.hpp"

namespace spikeloop::view {
namespace {

constexpr std::size_t kReadBytes = std::size_t{4} << 10;
constexpr std::size_t kWriteBytes = std::size_t{64} << 10;
constexpr std::size_t kInputBytes = std::size_t{24} << 10;  // more than any valid message

bool is_temporary(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

Connection::Connection(Accepted accepted, TimeNs now)
    : socket_(std::move(accepted.socket)),
      address_(accepted.address),
      since_(now),
      received_(now),
      progress_(now) {}

Connection::~Connection() {
  if (client_) {
    client_->gone = true;
  }
}

void Connection::change(State state, TimeNs now) {
  state_ = state;
  since_ = now;
}

void Connection::begin_response(SharedClient client, TimeNs now) {
  client_ = std::move(client);
  has_served_ = true;
  change(State::response, now);
}

void Connection::begin_viewer(SharedClient client, TimeNs now) {
  client_ = std::move(client);
  change(State::viewer, now);
}

void Connection::begin_closing(TimeNs now) {
  if (client_) {
    client_->gone = true;
    client_.reset();
  }
  frame_.reset();
  change(State::closing, now);
}

bool Connection::receive(TimeNs now) {
  std::array<char, kReadBytes>
      bytes;  // NOLINT(cppcoreguidelines-pro-type-member-init): recv fills it
  const ssize_t size = ::recv(fd(), bytes.data(), bytes.size(), 0);
  if (size <= 0) {
    return size < 0 && is_temporary(errno);
  }
  received_ = now;
  if (state_ != State::closing) {
    input.append(bytes.data(), static_cast<std::size_t>(size));
  }
  return true;
}

bool Connection::wants_to_receive() const {
  return state_ == State::viewer ? budget > 0 && input.size() < kInputBytes
                                 : state_ != State::response || input.size() < kReadBytes;
}

bool Connection::wants_to_write() const {
  return output_at_ < output_.size() || frame_ || !own_.empty() ||
         (state_ == State::closing && !shut_) ||
         (client_ && (client_->outbox.is_closed() || (!client_->outbox.is_empty() && !locked_)));
}

bool Connection::lags(TimeNs now, TimeNs patience) {
  locked_ = false;
  if (!wants_to_write()) {
    progress_ = now;
  }
  return now - progress_ > patience;
}

/// The next frame of the client. False if there is none.
bool Connection::begin_frame(TimeNs now) {
  if (!client_) {
    return false;
  }
  const auto next = client_->outbox.pop();
  if (!next) {
    locked_ = !client_->outbox.is_empty();
    return false;
  }
  if (!next->frame) {
    client_.reset();
    change(State::request, now);
    return true;
  }
  frame_ = next->frame;
  frame_at_ = 0;
  if (frame_->kind != Frame::Kind::raw) {
    const bool is_text = frame_->kind == Frame::Kind::text;
    output_ += frame_header(is_text ? Opcode::text : Opcode::binary, frame_->bytes.size());
  }
  if (frame_->kind == Frame::Kind::data) {
    // Little endian, like all numbers of Foxglove's protocol.
    output_.append(frame_->bytes, 0, kSubscriptionAt);
    output_.append(reinterpret_cast<const char*>(&next->subscription), sizeof(next->subscription));
    frame_at_ = kSubscriptionAt + sizeof(next->subscription);
  }
  return true;
}

void Connection::fill(TimeNs now) {
  output_.clear();
  output_at_ = 0;
  while (output_.size() < kWriteBytes) {
    if (frame_) {
      const std::size_t size =
          std::min(frame_->bytes.size() - frame_at_, kWriteBytes - output_.size());
      output_.append(frame_->bytes, frame_at_, size);
      frame_at_ += size;
      if (frame_at_ == frame_->bytes.size()) {
        frame_.reset();
      }
    } else if (!own_.empty()) {
      output_ += std::exchange(own_, {});
    } else if (!begin_frame(now)) {
      break;
    }
  }
}

bool Connection::write(TimeNs now) {
  if (client_ && client_->outbox.is_closed()) {
    return false;
  }
  if (output_at_ == output_.size()) {
    fill(now);
  }
  if (output_.empty()) {
    if (state_ == State::closing && !std::exchange(shut_, true)) {
      ::shutdown(fd(), SHUT_WR);
    }
    return true;
  }
  const ssize_t size = ::send(fd(), output_.data() + output_at_, output_.size() - output_at_,
                              MSG_NOSIGNAL | MSG_DONTWAIT);
  if (size < 0) {
    return is_temporary(errno);
  }
  output_at_ += static_cast<std::size_t>(size);
  progress_ = now;
  return true;
}

}  // namespace spikeloop::view
