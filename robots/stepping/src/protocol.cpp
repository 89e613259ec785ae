#include "spikeloop/stepping/protocol.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"

namespace spikeloop::stepping {
namespace {

using nlohmann::json;

/// Reads one message; what it throws names the topic and the text.
template <typename Read>
auto read_json(const char* topic, std::string_view text, Read&& read) {
  constexpr std::size_t kShown = 200;
  try {
    return read(json::parse(text));
  } catch (const json::exception& error) {
    throw TransportError(with_code(
        Code::partner_failed,
        "topic {} has brought '{}{}', which is not a message of the stepping protocol ({}); "
        "docs/stepping.md has them",
        topic, text.substr(0, kShown), text.size() > kShown ? "..." : "", error.what()));
  }
}

bool is_set(const json& object, const char* key) {
  return object.contains(key) && object.at(key).get<bool>();
}

}  // namespace

std::string to_text(const Request& request) {
  switch (request.kind) {
    case Request::Kind::begin:
      return json{{"begin", true},
                  {"run", request.run},
                  {"tick_ns", request.tick},
                  {"sensors", request.sensors},
                  {"commands", request.commands}}
          .dump();
    case Request::Kind::end:
      return json{{"end", true}}.dump();
    case Request::Kind::step:
      break;
  }
  return json{{"to_ns", request.to}, {"sent", request.sent}}.dump();
}

std::string to_text(const Answer& answer) {
  if (!answer.error.empty()) {
    return json{{"error", answer.error}}.dump();
  }
  return json{{"time_ns", answer.time}, {"published", answer.published}}.dump();
}

Request read_request(std::string_view text) {
  return read_json(kStepTopic, text, [](const json& object) {
    Request request;
    if (is_set(object, "begin")) {
      request.kind = Request::Kind::begin;
      request.run = object.value("run", std::uint64_t{0});
      request.tick = object.at("tick_ns").get<TimeNs>();
      request.sensors = object.at("sensors").get<std::vector<std::string>>();
      request.commands = object.at("commands").get<std::vector<std::string>>();
    } else if (is_set(object, "end")) {
      request.kind = Request::Kind::end;
    } else {
      request.to = object.at("to_ns").get<TimeNs>();
      request.sent = object.at("sent").get<Counts>();
    }
    return request;
  });
}

Answer read_answer(std::string_view text) {
  return read_json(kSteppedTopic, text, [](const json& object) {
    Answer answer;
    if (object.contains("error")) {
      answer.error = object.at("error").get<std::string>();
      return answer;
    }
    answer.time = object.at("time_ns").get<TimeNs>();
    answer.published = object.at("published").get<Counts>();
    answer.at_least = is_set(object, "at_least");
    answer.subscribers = object.value("subscribers", Counts{});
    return answer;
  });
}

std::vector<std::byte> string_message(messages::Dialect ros, std::string_view text) {
  const messages::MessageWriter writer(messages::Catalog::builtin(ros), kType, {"data"});
  std::vector<std::byte> bytes;
  const messages::FieldValue value{{}, text};
  writer.write(std::span(&value, 1), bytes);
  return bytes;
}

std::string text_of(messages::Dialect ros, std::span<const std::byte> message) {
  const messages::TextField data(messages::Catalog::builtin(ros), kType, "data");
  std::vector<std::string_view> texts;
  data.read(message, texts);
  return std::string(texts.at(0));
}

}  // namespace spikeloop::stepping
