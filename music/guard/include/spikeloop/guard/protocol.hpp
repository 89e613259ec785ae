// What a command adapter, its guard and the launcher tell each other: packets of CBOR over a Unix
// socket that knows when the other side has gone.
//
// An adapter sends "hello" and receives "ready" or "refused", and "reaches" once a robot subscribes
// to the guard; then both send "beat" until the adapter is "done". A guard sends to the launcher
// that started it "listening", then "beat", "log" with text for the user, and "stopped" after the
// zero commands to a robot whose adapter had died.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::guard {

/// The environment variable that holds the path of the guard's socket.
inline constexpr const char* kSocketVariable = "SPIKELOOP_GUARD";

/// Both sides must be of the same.
inline constexpr int kProtocol = 4;

/// How a command adapter introduces itself.
struct Hello {
  int protocol = kProtocol;
  std::string process;  ///< the section's label
  std::string topic;
  std::string message_type;  ///< "geometry_msgs/Twist"; the guard knows the same definitions
  int ros = 1;               ///< its version: 1 or 2
  std::map<std::string, std::string> place;  ///< variables that say where the robot's nodes meet
  TimeNs watchdog = 0;          ///< wall time after which the adapter stops the robot itself
  std::vector<std::byte> zero;  ///< the message that stops the robot, as the adapter sends it
};

nlohmann::json to_packet(const Hello& hello);
/// Nothing when the packet is not a hello, or of another protocol that says it in another way.
std::optional<Hello> read_hello(const nlohmann::json& packet);

nlohmann::json make_packet(std::string_view type);
/// Empty for what is not a packet of ours.
std::string type_of(const nlohmann::json& packet);
/// Empty when there is none.
std::string text_of(const nlohmann::json& packet, const char* key);

/// Never waits. Returns 0 or an errno: EAGAIN when there is no room.
int send_packet(int fd, const nlohmann::json& packet);

/// Sends "beat" unless an earlier packet is still unread: beats must not fill the socket of a
/// process that is stopped.
void send_beat(int fd);

struct Received {
  bool closed = false;   ///< the other side has gone, and all it said has been read
  bool nothing = false;  ///< not yet
  nlohmann::json packet{};
};
/// Never waits.
Received receive_packet(int fd);
/// Waits until something can be read. False when `timeout` (wall time) has passed.
bool wait_readable(int fd, TimeNs timeout);

}  // namespace spikeloop::guard
