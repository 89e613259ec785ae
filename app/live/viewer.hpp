// One viewer, its subscriptions and the answers to its messages. The protocol is Foxglove's
// (https://github.com/foxglove/ws-protocol, docs/spec.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hub.hpp"
#include "outbox.hpp"

namespace spikeloop::view {

SharedFrame text_frame(const nlohmann::json& message);
/// A message of the operation messageData. The number of the viewer's subscription is inserted at
/// kSubscriptionAt when the frame is sent.
SharedFrame data_frame(TimeNs time, std::span<const std::byte> message);
SharedFrame time_frame(TimeNs time);
inline constexpr std::size_t kSubscriptionAt = 1;  // position after the opcode

class Viewer {
 public:
  Viewer(Hub& hub, SharedClient client) : hub_(hub), client_(std::move(client)) {}

  /// serverInfo, and all channels.
  /// @param session differs from run to run
  void greet(const std::string& name, const nlohmann::json& metadata, const std::string& session);
  void advertise(std::size_t from, std::size_t to);
  /// Answers a message of the viewer.
  /// @param newest the newest message of every channel, for channels that seldom bring one
  void take(const nlohmann::json& message, const std::vector<SharedFrame>& newest);
  /// Sends a message of a channel, if the viewer subscribes to it.
  void send(std::uint32_t channel, const SharedFrame& frame);
  void send(SharedFrame frame);
  /// @param id of the request; @param names only these; empty: all
  void send_parameters(const nlohmann::json& id = nullptr,
                       const std::vector<std::string>& names = {});

  const Client& client() const { return *client_; }
  bool wants_parameters() const { return wants_parameters_; }

 private:
  void subscribe(const nlohmann::json& message, const std::vector<SharedFrame>& newest);
  void set_parameters(const nlohmann::json& message);
  void complain(const std::string& text);
  void unsubscribe(const nlohmann::json& message);

  Hub& hub_;
  SharedClient client_;
  bool wants_parameters_ = false;
  std::vector<std::optional<std::uint32_t>> subscriptions_{};  ///< index: channel
};

}  // namespace spikeloop::view
