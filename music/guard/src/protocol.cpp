#include "spikeloop/guard/protocol.hpp"

#include <linux/sockios.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include "spikeloop/core/pacer.hpp"

namespace spikeloop::guard {
namespace {

const std::string kPlace = "place.";  // prefix of the keys of Hello::place

const std::string kStop = "stop";  // a packet, and the key of its message

std::string text_from(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void append(std::string_view text, std::string& bytes) {
  const auto size = static_cast<std::uint32_t>(text.size());
  bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
  bytes += text;
}

/// Removes the first text from `bytes`; nullopt if `bytes` is too short.
std::optional<std::string> take_text(std::string_view& bytes) {
  std::uint32_t size = 0;
  if (bytes.size() < sizeof size) {
    return std::nullopt;
  }
  std::memcpy(&size, bytes.data(), sizeof size);
  bytes.remove_prefix(sizeof size);
  if (bytes.size() < size) {
    return std::nullopt;
  }
  std::string text(bytes.substr(0, size));
  bytes.remove_prefix(size);
  return text;
}

}  // namespace

std::string encode(const Packet& packet) {
  std::string bytes;
  append(packet.type, bytes);
  for (const auto& [key, value] : packet.fields) {
    append(key, bytes);
    append(value, bytes);
  }
  return bytes;
}

Packet decode(std::string_view bytes) {
  Packet packet;
  const auto type = take_text(bytes);
  while (type && !bytes.empty()) {
    const auto key = take_text(bytes);
    auto value = take_text(bytes);
    if (!key || !value) {
      return {};
    }
    packet.fields[*key] = std::move(*value);
  }
  packet.type = type.value_or("");
  return packet;
}

Packet to_packet(const Hello& hello) {
  Packet packet{"hello",
                {{"protocol", fmt::to_string(hello.protocol)},
                 {"process", hello.process},
                 {"topic", hello.topic},
                 {"message_type", hello.message_type},
                 {"ros", fmt::to_string(hello.ros)},
                 {"watchdog", fmt::to_string(hello.watchdog)},
                 {kStop, text_from(hello.stop)}}};
  for (const auto& [name, value] : hello.place) {
    packet.fields[kPlace + name] = value;
  }
  return packet;
}

std::optional<Hello> read_hello(const Packet& packet) {
  const auto protocol = integer_of(packet, "protocol");
  const auto ros = integer_of(packet, "ros");
  const auto watchdog = integer_of(packet, "watchdog");
  if (packet.type != "hello" || protocol != kProtocol || !ros || !watchdog) {
    return std::nullopt;
  }
  Hello hello{.process = text_of(packet, "process"),
              .topic = text_of(packet, "topic"),
              .message_type = text_of(packet, "message_type"),
              .ros = static_cast<int>(*ros),
              .watchdog = *watchdog,
              .stop = stop_message(packet)};
  for (const auto& [key, value] : packet.fields) {
    if (key.starts_with(kPlace)) {
      hello.place[key.substr(kPlace.size())] = value;
    }
  }
  return hello;
}

Packet stop_packet(const std::vector<std::byte>& message) {
  return {kStop, {{kStop, text_from(message)}}};
}

std::vector<std::byte> stop_message(const Packet& packet) {
  const std::string text = text_of(packet, kStop);
  const auto* const bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

std::string text_of(const Packet& packet, const std::string& key) {
  const auto found = packet.fields.find(key);
  return found == packet.fields.end() ? "" : found->second;
}

std::optional<std::int64_t> integer_of(const Packet& packet, const std::string& key) {
  const std::string text = text_of(packet, key);
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  return read.ec == std::errc() && read.ptr == end ? std::optional(value) : std::nullopt;
}

int send_packet(int fd, const Packet& packet) {
  const std::string bytes = encode(packet);
  if (bytes.size() > kLongestPacket) {
    return EMSGSIZE;
  }
  while (send(fd, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL) < 0) {
    if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

Received receive_packet(int fd) {
  auto size = recv(fd, nullptr, 0, MSG_PEEK | MSG_TRUNC | MSG_DONTWAIT);
  if (size < 0 && errno == ECONNRESET) {
    // ECONNRESET: the peer closed with unread packets; the packets that it sent can still be read.
    size = recv(fd, nullptr, 0, MSG_PEEK | MSG_TRUNC | MSG_DONTWAIT);
  }
  if (size < 0) {
    const bool later = errno == EAGAIN || errno == EINTR;
    return {.closed = !later, .nothing = later};
  }
  // Longer packets are truncated.
  std::string bytes(std::min(static_cast<std::size_t>(size), kLongestPacket), '\0');
  const auto received = recv(fd, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (received <= 0) {
    return {.closed = true};
  }
  return {.packet = static_cast<std::size_t>(size) > kLongestPacket ? Packet{} : decode(bytes)};
}

bool has_unread(int fd) {
  int unread = 0;
  return ioctl(fd, SIOCOUTQ, &unread) == 0 && unread > 0;
}

void send_beat(int fd) {
  if (!has_unread(fd)) {
    send_packet(fd, {"beat"});
  }
}

bool wait_readable(int fd, TimeNs timeout) {
  const TimeNs deadline = wall_now() + timeout;
  while (true) {
    const TimeNs left = std::max<TimeNs>(0, deadline - wall_now());
    const timespec time{left / kNsPerSecond, left % kNsPerSecond};
    pollfd file{fd, POLLIN, 0};
    const int ready = ppoll(&file, 1, &time, nullptr);
    if (ready >= 0 || errno != EINTR) {
      return ready > 0;
    }
  }
}

}  // namespace spikeloop::guard
