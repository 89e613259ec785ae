#include "viewer.hpp"

#include <fmt/format.h>
#include <libwebsockets.h>

#include <algorithm>
#include <cstring>

#include "spikeloop/core/parse_message.hpp"

namespace spikeloop::view {
namespace {

using nlohmann::json;

// Opcodes of the protocol's binary messages.
constexpr unsigned char kMessageData = 1;
constexpr unsigned char kTime = 2;
constexpr std::size_t kSubscriptionAt = 1;  // behind the opcode
constexpr std::size_t kTimeAt = 5;
constexpr std::size_t kMessageAt = 13;

/// Of frames that wait for one viewer.
constexpr std::size_t kMostBytes = std::size_t{16} << 20;
constexpr std::size_t kMostSubscriptions = 10'000;

SharedFrame binary_frame(std::size_t size) {
  auto frame = std::make_shared<Frame>();
  frame->binary = true;
  frame->bytes.resize(LWS_PRE + size);
  return frame;
}

/// The protocol counts channels from 1: viewers take 0 for none.
std::uint32_t id_of(std::size_t channel) {
  return static_cast<std::uint32_t>(channel + 1);
}

}  // namespace

std::size_t Frame::size() const {
  return bytes.size() - LWS_PRE;
}

unsigned char* Frame::payload() {
  return bytes.data() + LWS_PRE;
}

SharedFrame text_frame(const json& message) {
  const std::string text = message.dump(-1, ' ', false, json::error_handler_t::replace);
  auto frame = std::make_shared<Frame>();
  frame->bytes.resize(LWS_PRE + text.size());
  std::ranges::copy(text, frame->payload());
  return frame;
}

SharedFrame data_frame(TimeNs time, std::span<const std::byte> message) {
  auto frame = binary_frame(kMessageAt + message.size());
  frame->payload()[0] = kMessageData;
  std::memcpy(frame->payload() + kTimeAt, &time, sizeof(time));
  if (!message.empty()) {
    std::memcpy(frame->payload() + kMessageAt, message.data(), message.size());
  }
  return frame;
}

SharedFrame time_frame(TimeNs time) {
  auto frame = binary_frame(1 + sizeof(time));
  frame->payload()[0] = kTime;
  std::memcpy(frame->payload() + 1, &time, sizeof(time));
  return frame;
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

void Viewer::take(std::string_view text, const std::vector<SharedFrame>& newest) {
  const json message = parse_message<json>(text);
  const std::string op = message.is_object() && message.contains("op") && message["op"].is_string()
                             ? message["op"]
                             : "";
  try {
    if (op == "subscribe") {
      subscribe(message, newest);
    } else if (op == "unsubscribe") {
      for (const json& id : message.at("subscriptionIds")) {
        channels_.erase(id.get<std::uint32_t>());
      }
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

void Viewer::subscribe(const json& message, const std::vector<SharedFrame>& newest) {
  for (const json& subscription : message.at("subscriptions")) {
    const auto id = subscription.at("id").get<std::uint32_t>();
    const auto channel = subscription.at("channelId").get<std::uint32_t>();
    if (channel == 0 || channel > newest.size()) {
      complain(fmt::format("there is no channel {}", channel));
    } else if (channels_.size() == kMostSubscriptions) {
      complain("there are too many subscriptions");
    } else {
      channels_[id] = channel - 1;
      hub_.watch();
      if (const SharedFrame& frame = newest[channel - 1]) {
        push({frame, true, id});
      }
    }
  }
}

void Viewer::set_parameters(const json& message) {
  for (const json& parameter : message.at("parameters")) {
    const auto name = parameter.at("name").get<std::string>();
    const json value = parameter.value("value", json());
    if (!may_control_ && !Hub::needs_no_token(name, value)) {
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
  for (const auto& [subscription, subscribed] : channels_) {
    if (subscribed == channel) {
      push({frame, true, subscription});
    }
  }
}

void Viewer::send(SharedFrame frame) {
  push({std::move(frame), false, 0});
}

void Viewer::push(Waiting waiting) {
  queued_bytes_ += waiting.frame->size();
  queue_.push_back(std::move(waiting));
  while (queued_bytes_ > kMostBytes) {
    const auto oldest = std::ranges::find(queue_, true, &Waiting::is_data);
    if (oldest == queue_.end()) {
      hangs_ = true;  // it asks and asks, and reads no answer
      return;
    }
    queued_bytes_ -= oldest->frame->size();
    ++dropped_;
    queue_.erase(oldest);
  }
}

SharedFrame Viewer::pop() {
  const Waiting waiting = std::move(queue_.front());
  queue_.pop_front();
  queued_bytes_ -= waiting.frame->size();
  if (waiting.is_data) {
    // Viewers share the frame, and are written to one after the other.
    std::memcpy(waiting.frame->payload() + kSubscriptionAt, &waiting.subscription,
                sizeof(waiting.subscription));
  }
  return waiting.frame;
}

}  // namespace spikeloop::view
