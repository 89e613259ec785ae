// One viewer: what it subscribed to, and what waits for it. The protocol is Foxglove's
// (https://github.com/foxglove/ws-protocol, docs/spec.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hub.hpp"

namespace spikeloop::view {

/// A frame, behind room for what the library writes before it.
struct Frame {
  bool binary = false;
  std::vector<unsigned char> bytes;
  std::size_t size() const;
  unsigned char* payload();
};
using SharedFrame = std::shared_ptr<Frame>;

SharedFrame text_frame(const nlohmann::json& message);
/// Of messageData; each viewer's number of its subscription is set by pop().
SharedFrame data_frame(TimeNs time, std::span<const std::byte> message);
SharedFrame time_frame(TimeNs time);

class Viewer {
 public:
  /// @param may_control it has the token
  Viewer(Hub& hub, bool may_control) : hub_(hub), may_control_(may_control) {}

  /// serverInfo, and all channels.
  /// @param session differs from run to run
  void greet(const std::string& name, const nlohmann::json& metadata, const std::string& session);
  void advertise(std::size_t from, std::size_t to);
  /// A text frame has come.
  /// @param newest the newest message of every channel, for channels that seldom bring one
  void take(std::string_view text, const std::vector<SharedFrame>& newest);
  /// A message of a channel. When too much waits, the oldest messages are dropped and counted.
  void send(std::uint32_t channel, const SharedFrame& frame);
  void send(SharedFrame frame);
  /// @param id of the request; @param names only these; empty: all
  void send_parameters(const nlohmann::json& id = nullptr,
                       const std::vector<std::string>& names = {});

  bool waits() const { return !queue_.empty(); }
  /// The next one, to be written before another viewer's.
  SharedFrame pop();
  std::uint64_t dropped() const { return dropped_; }
  /// Nothing can be done for it.
  bool hangs() const { return hangs_; }
  bool wants_parameters() const { return wants_parameters_; }

 private:
  struct Waiting {
    SharedFrame frame;
    bool is_data;
    std::uint32_t subscription;
  };

  void subscribe(const nlohmann::json& message, const std::vector<SharedFrame>& newest);
  void set_parameters(const nlohmann::json& message);
  void complain(const std::string& text);
  void push(Waiting waiting);

  Hub& hub_;
  bool may_control_;
  bool wants_parameters_ = false;
  bool hangs_ = false;
  std::map<std::uint32_t, std::uint32_t> channels_;  ///< by subscription
  std::deque<Waiting> queue_;
  std::size_t queued_bytes_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace spikeloop::view
