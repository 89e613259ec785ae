#include "viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "access.hpp"

namespace spikeloop::view {
namespace {

using nlohmann::json;

// Opcodes of the protocol's binary messages.
constexpr char kMessageData = 1;
constexpr char kTime = 2;
constexpr std::size_t kTimeAt = 5;
constexpr std::size_t kMessageAt = 13;

/// The protocol counts channels from 1: viewers take 0 for none.
std::uint32_t id_of(std::size_t channel) {
  return static_cast<std::uint32_t>(channel + 1);
}

}  // namespace

SharedFrame text_frame(const json& message) {
  return std::make_shared<Frame>(Frame::Kind::text,
                                 message.dump(-1, ' ', false, json::error_handler_t::replace));
}

SharedFrame data_frame(TimeNs time, std::span<const std::byte> message) {
  std::string bytes(kMessageAt, kMessageData);
  std::memcpy(bytes.data() + kTimeAt, &time, sizeof(time));
  bytes.append(reinterpret_cast<const char*>(message.data()), message.size());
  return std::make_shared<Frame>(Frame::Kind::data, std::move(bytes));
}

SharedFrame time_frame(TimeNs time) {
  std::string bytes(1 + sizeof(time), kTime);
  std::memcpy(bytes.data() + 1, &time, sizeof(time));
  return std::make_shared<Frame>(Frame::Kind::time, std::move(bytes));
}

void Viewer::greet(const std::string& name, const json& metadata, const std::string& session) {
  send(text_frame({{"op", "serverInfo"},
                   {"name", name},
                   {"capabilities", {"time", "parameters", "parametersSubscribe"}},
                   {"supportedEncodings", json::array()},
                   {"metadata", metadata},
                   {"sessionId", session}}));
}

void Viewer::advertise(std::size_t from, std::size_t to) {
  json channels = json::array();
  for (std::size_t i = from; i < to; ++i) {
    const live::Channel& channel = hub_.channel(i);
    channels.push_back({{"id", id_of(i)},
                        {"topic", channel.topic},
                        {"encoding", channel.encoding},
                        {"schemaName", channel.schema_name},
                        {"schemaEncoding", channel.schema_encoding},
                        {"schema", channel.schema}});
  }
  send(text_frame({{"op", "advertise"}, {"channels", channels}}));
}

void Viewer::take(const json& message, const std::vector<SharedFrame>& newest) {
  const std::string op = message.is_object() && message.contains("op") && message["op"].is_string()
                             ? message["op"]
                             : "";
  try {
    if (op == "subscribe") {
      subscribe(message, newest);
    } else if (op == "unsubscribe") {
      unsubscribe(message);
    } else if (op == "getParameters") {
      send_parameters(message.value("id", json()),
                      message.value("parameterNames", std::vector<std::string>()));
    } else if (op == "subscribeParameterUpdates") {
      wants_parameters_ = true;
    } else if (op == "unsubscribeParameterUpdates") {
      wants_parameters_ = false;
    } else if (op == "setParameters") {
      set_parameters(message);
    } else {
      complain(fmt::format("this server does not know the operation '{}'", op));
    }
  } catch (const json::exception&) {
    complain(fmt::format("the message '{}' is not as the protocol has it", op));
  }
}

/// Adds at most one subscription per channel, and sends one answer for all refused ones.
void Viewer::subscribe(const json& message, const std::vector<SharedFrame>& newest) {
  subscriptions_.resize(newest.size());
  std::string refusal;
  for (const json& subscription : message.at("subscriptions")) {
    const auto id = subscription.at("id").get<std::uint32_t>();
    const auto channel = subscription.at("channelId").get<std::uint32_t>();
    if (channel == 0 || channel > newest.size()) {
      refusal = fmt::format("there is no channel {}", channel);
    } else if (auto& present = subscriptions_[channel - 1]; present) {
      refusal = fmt::format("subscription {} to channel {} exists; end it before another one",
                            *present, channel);
    } else {
      present = id;
      hub_.watch();
      if (const SharedFrame& frame = newest[channel - 1]) {
        client_->outbox.push({frame, id});
      }
    }
  }
  if (!refusal.empty()) {
    complain(refusal);
  }
}

void Viewer::unsubscribe(const json& message) {
  const auto ids = message.at("subscriptionIds").get<std::set<std::uint32_t>>();
  for (auto& subscription : subscriptions_) {
    if (subscription && ids.contains(*subscription)) {
      subscription.reset();
    }
  }
}

void Viewer::set_parameters(const json& message) {
  for (const json& parameter : message.at("parameters")) {
    const auto name = parameter.at("name").get<std::string>();
    const json value = parameter.value("value", json());
    if (!client_->may_control && !needs_no_token(name, value)) {
      complain(
          fmt::format("'{}' can be set with the address that the run has printed, which has a "
                      "token",
                      name));
    } else if (const std::string wrong = hub_.set(name, value); !wrong.empty()) {
      complain(wrong);
    }
  }
  send_parameters(message.value("id", json()));
}

void Viewer::send_parameters(const json& id, const std::vector<std::string>& names) {
  json parameters = json::array();
  for (const json& parameter : hub_.parameters()) {
    if (names.empty() ||
        std::ranges::find(names, parameter.at("name").get<std::string>()) != names.end()) {
      parameters.push_back(parameter);
    }
  }
  json message{{"op", "parameterValues"}, {"parameters", parameters}};
  if (id.is_string()) {
    message["id"] = id;
  }
  send(text_frame(message));
}

void Viewer::complain(const std::string& text) {
  send(text_frame({{"op", "status"}, {"level", 2}, {"message", text}}));
}

void Viewer::send(std::uint32_t channel, const SharedFrame& frame) {
  if (channel < subscriptions_.size() && subscriptions_[channel]) {
    client_->outbox.push({frame, *subscriptions_[channel]});
  }
}

void Viewer::send(SharedFrame frame) {
  client_->outbox.push({std::move(frame)});
}

}  // namespace spikeloop::view
