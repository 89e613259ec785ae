#include "spikeloop/guard/protocol.hpp"

#include <linux/sockios.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

#include "spikeloop/core/pacer.hpp"

namespace spikeloop::guard {

using nlohmann::json;

json to_packet(const Hello& hello) {
  std::vector<std::uint8_t> zero(hello.zero.size());
  std::ranges::transform(hello.zero, zero.begin(),
                         [](std::byte byte) { return static_cast<std::uint8_t>(byte); });
  json packet = make_packet("hello");
  packet["protocol"] = hello.protocol;
  packet["process"] = hello.process;
  packet["topic"] = hello.topic;
  packet["message_type"] = hello.message_type;
  packet["ros"] = hello.ros;
  packet["place"] = hello.place;
  packet["watchdog"] = hello.watchdog;
  packet["zero"] = json::binary(std::move(zero));
  return packet;
}

std::optional<Hello> read_hello(const json& packet) {
  if (type_of(packet) != "hello") {
    return std::nullopt;
  }
  try {
    Hello hello;
    hello.protocol = packet.at("protocol").get<int>();
    hello.process = packet.at("process").get<std::string>();
    hello.topic = packet.at("topic").get<std::string>();
    hello.message_type = packet.at("message_type").get<std::string>();
    hello.ros = packet.at("ros").get<int>();
    hello.place = packet.at("place").get<std::map<std::string, std::string>>();
    hello.watchdog = packet.at("watchdog").get<TimeNs>();
    for (const std::uint8_t byte : packet.at("zero").get_binary()) {
      hello.zero.push_back(std::byte{byte});
    }
    return hello;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

json make_packet(std::string_view type) {
  return {{"type", type}};
}

std::string text_of(const json& packet, const char* key) {
  const bool has = packet.is_object() && packet.contains(key) && packet[key].is_string();
  return has ? packet[key].get<std::string>() : "";
}

std::string type_of(const json& packet) {
  return text_of(packet, "type");
}

int send_packet(int fd, const json& packet) {
  const std::vector<std::uint8_t> bytes = json::to_cbor(packet);
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
    // The other side had not read all before it closed its end; what it has sent is still there.
    size = recv(fd, nullptr, 0, MSG_PEEK | MSG_TRUNC | MSG_DONTWAIT);
  }
  if (size < 0) {
    const bool later = errno == EAGAIN || errno == EINTR;
    return {.closed = !later, .nothing = later};
  }
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  const auto received = recv(fd, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (received <= 0) {
    return {.closed = true};
  }
  // What is not CBOR becomes a packet without a type.
  return {.packet = json::from_cbor(bytes, true, false)};
}

void send_beat(int fd) {
  int unread = 0;
  if (ioctl(fd, SIOCOUTQ, &unread) == 0 && unread > 0) {
    return;
  }
  send_packet(fd, make_packet("beat"));
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
