#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/parse_message.hpp"
#include "spikeloop/status/address.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::status {
namespace {

using nlohmann::json;

/// More than the kernel's default limit.
constexpr std::size_t kLongestDatagram = 4 << 20;

/// One datagram, whole; nothing when there is none or it is not a message.
std::optional<json> receive(int fd) {
  const auto size = recv(fd, nullptr, 0, MSG_PEEK | MSG_TRUNC | MSG_DONTWAIT);
  if (size < 0) {
    return std::nullopt;
  }
  // A longer datagram is truncated and then rejected as JSON.
  std::string text(std::min(static_cast<std::size_t>(size), kLongestDatagram), '\0');
  const auto received = recv(fd, text.data(), text.size(), MSG_DONTWAIT);
  text.resize(received < 0 ? 0 : static_cast<std::size_t>(received));
  json message = parse_message<json>(text);
  const auto has_text = [&message](const char* key) {
    return message.contains(key) && message[key].is_string();
  };
  if (!message.is_object() || !has_text("type") || !has_text("process")) {
    return std::nullopt;
  }
  return message;
}

}  // namespace

Receiver::Receiver(const std::string& path)
    : path_(path), socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  const auto address = socket_address(path);
  if (!address) {
    throw FileError("make the status socket", path, ENAMETOOLONG);
  }
  enlarge(socket_.get(), SO_RCVBUF);
  if (bind(socket_.get(), generic(*address), sizeof *address) != 0) {
    throw FileError("make the status socket", path, errno);
  }
}

Receiver::~Receiver() {
  unlink(path_.c_str());
}

std::optional<json> Receiver::next(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    pollfd waiting{socket_.get(), POLLIN, 0};
    const int ready = poll(&waiting, 1, static_cast<int>(std::max<long>(left.count(), 0)));
    if (ready == 0) {
      return std::nullopt;
    }
    if (ready > 0) {
      if (auto message = receive(socket_.get())) {
        return message;
      }
    }
    if (left.count() <= 0) {
      return std::nullopt;  // a flood of invalid datagrams must not block the caller
    }
  }
}

}  // namespace spikeloop::status
