// Protocol between command adapter, guard and launcher: packets over a Unix SOCK_SEQPACKET socket,
// which reports when the peer closes it. A packet is a list of texts: its type, and the keys and
// values of its fields, each after its length in 4 bytes. It is read without recursion and in
// bounded memory: any program of the user can send to the guard.
//
// An adapter sends "hello" and receives "ready" or "refused", and "reaches" once a robot subscribes
// to the guard; then both send "beat" until the adapter is "done". The adapter sends "stop" when
// the message changes that stops the robot, because a stop holds positions. A guard sends to the
// launcher that started it "listening", then "beat", "log" with text for the user, and "stopped"
// after the stop commands to a robot whose adapter had died.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::guard {

/// The environment variable that holds the path of the guard's socket.
inline constexpr const char* kSocketVariable = "SPIKELOOP_GUARD";

inline constexpr int kProtocol = 5;

/// Longest packet in bytes; a longer one is not sent, and not read.
inline constexpr std::size_t kLongestPacket = 1 << 20;

struct Packet {
  std::string type{};  ///< empty if the bytes are not a packet
  std::map<std::string, std::string> fields{};
};

std::string encode(const Packet& packet);
Packet decode(std::string_view bytes);

/// Field of "refused": the adapter must not drive the robot.
inline constexpr const char* kEndsRun = "ends_run";

/// First packet of a command adapter.
struct Hello {
  int protocol = kProtocol;
  std::string process{};  ///< label of the section
  std::string topic{};
  std::string message_type{};  ///< "geometry_msgs/Twist"; the guard has the same definitions
  int ros = 1;                 ///< version of ROS: 1 or 2
  std::map<std::string, std::string> place{};  ///< variables that define where nodes meet
  TimeNs watchdog = 0;  ///< wall time after which the adapter stops the robot itself
  /// The message that stops the robot, as the adapter sends it. Empty: no message, because the
  /// robot was not driven yet and its position is not known.
  std::vector<std::byte> stop{};
};

Packet to_packet(const Hello& hello);
/// nullopt if the packet is not a hello of this protocol.
std::optional<Hello> read_hello(const Packet& packet);

Packet stop_packet(const std::vector<std::byte>& message);
/// The message of a hello or a "stop".
std::vector<std::byte> stop_message(const Packet& packet);
/// The value of a field; empty if the packet has no such field.
std::string text_of(const Packet& packet, const std::string& key);
/// The integer in a field; nullopt if there is none.
std::optional<std::int64_t> integer_of(const Packet& packet, const std::string& key);

/// Does not wait. Returns 0 or an errno: EAGAIN if the socket is full.
int send_packet(int fd, const Packet& packet);

/// Sends "beat" unless an earlier packet is still unread: beats must not fill the socket of a
/// process that is stopped.
void send_beat(int fd);
/// True if the peer has not read an earlier packet yet.
bool has_unread(int fd);

struct Received {
  bool closed = false;   ///< the peer has closed the connection, and all its packets were read
  bool nothing = false;  ///< no packet has arrived
  Packet packet{};
};
/// Does not wait.
Received receive_packet(int fd);
/// Waits until the descriptor is readable. False after the wall time `timeout`.
bool wait_readable(int fd, TimeNs timeout);

}  // namespace spikeloop::guard
