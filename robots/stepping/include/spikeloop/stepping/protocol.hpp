// How an experiment steps a robot over two topics of std_msgs/String: docs/stepping.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::stepping {

inline constexpr const char* kStepTopic = "/spikeloop/step";
inline constexpr const char* kSteppedTopic = "/spikeloop/stepped";
inline constexpr const char* kType = "std_msgs/String";

/// Messages of each topic since the beginning of the run. Connections have no common order: whoever
/// waits for the counts has all that was sent before.
using Counts = std::map<std::string, std::uint64_t>;

/// What the experiment sends.
struct Request {
  enum class Kind { begin, step, end };
  Kind kind = Kind::step;
  /// begin: of this run alone. A request is repeated until it is answered; who has answered it
  /// answers again, and does nothing else. 0: an experiment that does not repeat.
  std::uint64_t run = 0;
  TimeNs tick = 0;                      ///< begin
  std::vector<std::string> sensors{};   ///< begin: topics that the experiment subscribes to
  std::vector<std::string> commands{};  ///< begin: topics that it publishes
  TimeNs to = 0;                        ///< step: advance to this time
  Counts sent{};                        ///< step: commands
};

/// What the robot answers to `begin` and `step`.
struct Answer {
  TimeNs time = 0;
  Counts published{};
  /// More messages may come than were counted; who answers for a simulator knows what has come.
  bool at_least = false;
  /// To `begin`, of a program that steps a simulator: number of nodes that subscribe to each
  /// command. Empty if unknown.
  Counts subscribers{};
  std::string error{};  ///< why it cannot; empty: all is well
};

/// The text of a message, JSON.
std::string to_text(const Request& request);
std::string to_text(const Answer& answer);
/// @throws TransportError with the text and what is wrong with it.
Request read_request(std::string_view text);
Answer read_answer(std::string_view text);

/// The bytes of a std_msgs/String, and back. @throws TransportError when they end too early.
std::vector<std::byte> string_message(messages::Dialect ros, std::string_view text);
std::string text_of(messages::Dialect ros, std::span<const std::byte> message);

}  // namespace spikeloop::stepping
