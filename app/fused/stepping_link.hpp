// sync: lockstep over ROS: the experiment's side of docs/stepping.md.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "spikeloop/stepping/protocol.hpp"
#include "spikeloop/topics/session.hpp"
#include "waiting.hpp"

namespace spikeloop {

/// A topic of the experiment's own.
struct SteppedTopic {
  std::string name;                      ///< as ROS resolves it
  std::function<bool()> connected;       ///< whether there is somebody at the other end
  std::function<std::uint64_t()> count;  ///< messages that have come or left
  std::function<void()> require_sound;   ///< throws what is wrong with it
  /// Set for commands only; see topics::RawPublisher::deliver().
  std::function<bool()> deliver{};
};

class SteppingLink {
 public:
  SteppingLink(topics::Session& session, TimeNs tick, Waiting& waiting);

  void add_sensor(SteppedTopic topic) {
    unknown_.insert(topic.name);
    sensors_.push_back(std::move(topic));
  }
  void add_command(SteppedTopic topic) { commands_.push_back(std::move(topic)); }

  // All of these come back when the loop is to end, and throw a TransportError when the robot does
  // not answer, or answers something else than was asked.

  /// Waits until everybody is connected; then the robot goes to its start.
  void begin();
  /// The robot advances to `time` on what has been sent; all that it has published is here.
  void advance(TimeNs time);
  /// Tells the robot that nothing more comes.
  void end();

 private:
  bool meet();
  void await_subscribers(const stepping::Counts& expected);
  std::string missing_subscribers(const stepping::Counts& expected) const;
  void deliver_commands();
  void ask(const stepping::Request& request);
  void repeat(const stepping::Request& request, TimeNs waited);
  void send(const stepping::Request& request);
  void take(std::span<const std::byte> message);
  std::optional<stepping::Answer> answer();
  bool has_come(const stepping::Answer& answer) const;
  std::string missing_connections();
  bool is_subscribed(bool connected, const std::string& topic);
  std::string missing_messages(const stepping::Answer& answer) const;
  void require_sound() const;
  void check(const stepping::Answer& answer) const;

  topics::Session& session_;
  TimeNs tick_;
  Waiting& waiting_;
  std::vector<SteppedTopic> sensors_;
  std::vector<SteppedTopic> commands_;
  std::set<std::string> unknown_{stepping::kSteppedTopic};  ///< may not arrive yet
  bool begun_ = false;
  bool counts_for_another_ = false;  ///< the answers come from a program that steps a simulator
  bool told_undelivered_ = false;
  TimeNs repeat_at_ = 0;  ///< of the wall time that a request has waited
  std::mutex mutex_;
  TimeNs asked_for_ = 0;  ///< written by the loop alone
  bool repeated_ = false;
  std::optional<stepping::Answer> answer_;
  std::string unreadable_;
  std::unique_ptr<topics::RawPublisher> steps_;
  std::unique_ptr<topics::RawSubscriber>
      answers_;  // the last: what its callback uses is there before it
};

}  // namespace spikeloop
