#include "spikeloop/stepping/protocol.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "spikeloop/core/error.hpp"
#include "tests/support/error_of.hpp"

namespace spikeloop::stepping {
namespace {

using messages::Dialect;
using nlohmann::json;
using test::error_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::IsEmpty;
using testing::StartsWith;

// The texts of docs/stepping.md.
TEST(Protocol, RequestsAsTheyAreDocumented) {
  const Request begin{.kind = Request::Kind::begin,
                      .run = 1795714272136,
                      .tick = 1'000'000,
                      .sensors = {"/scan"},
                      .commands = {"/cmd_vel"}};
  EXPECT_EQ(json::parse(to_text(begin)),
            json::parse(R"({"begin": true, "run": 1795714272136, "tick_ns": 1000000,
                            "sensors": ["/scan"], "commands": ["/cmd_vel"]})"));
  const Request step{.to = 1'000'000, .sent = {{"/cmd_vel", 1}}};
  EXPECT_EQ(json::parse(to_text(step)),
            json::parse(R"({"to_ns": 1000000, "sent": {"/cmd_vel": 1}})"));
  EXPECT_EQ(json::parse(to_text({.kind = Request::Kind::end})), json::parse(R"({"end": true})"));
}

TEST(Protocol, RequestsAreRead) {
  const Request begin =
      read_request(R"({"begin": true, "tick_ns": 5, "sensors": ["/a", "/b"], "commands": []})");
  EXPECT_EQ(begin.kind, Request::Kind::begin);
  EXPECT_EQ(begin.tick, 5);
  EXPECT_EQ(begin.run, 0U) << "one that is not repeated";
  EXPECT_EQ(read_request(to_text({.kind = Request::Kind::begin, .run = 7})).run, 7U);
  EXPECT_THAT(begin.sensors, ElementsAre("/a", "/b"));
  const Request step = read_request(R"({"to_ns": 9007199254740993, "sent": {"/c": 7}})");
  EXPECT_EQ(step.kind, Request::Kind::step);
  EXPECT_EQ(step.to, 9007199254740993) << "more than a double holds";
  EXPECT_EQ(step.sent, (Counts{{"/c", 7}}));
  EXPECT_EQ(read_request(R"({"end": true})").kind, Request::Kind::end);
}

TEST(Protocol, Answers) {
  const Answer answer{.time = 3, .published = {{"/scan", 2}, {"/odom", 0}}};
  EXPECT_EQ(json::parse(to_text(answer)),
            json::parse(R"({"time_ns": 3, "published": {"/odom": 0, "/scan": 2}})"));
  const Answer read = read_answer(to_text(answer));
  EXPECT_EQ(read.time, 3);
  EXPECT_EQ(read.published, answer.published);
  EXPECT_THAT(read.subscribers, IsEmpty());
  EXPECT_EQ(
      read_answer(R"({"time_ns": 0, "published": {}, "subscribers": {"/go": 2}})").subscribers,
      (Counts{{"/go", 2}}));
  EXPECT_EQ(read_answer(to_text({.error = "no \"fuel\""})).error, "no \"fuel\"");
}

TEST(Protocol, WhatIsNoMessageOfItIsNamed) {
  const auto wrong = [](const char* topic, const std::string& text) {
    return AllOf(StartsWith(std::string("topic ") + topic + " has brought '" + text +
                            "', which is not a message of the stepping protocol ("),
                 EndsWith("); docs/stepping.md has them [SL0703]"));
  };
  for (const std::string text : {"", "{", "[]", "7", R"({"to_ns": "1"})", R"({"to_ns": 1})",
                                 R"({"begin": true})", R"({"begin": 1})"}) {
    EXPECT_THAT(error_of<TransportError>([&] { read_request(text); }),
                wrong("/spikeloop/step", text));
  }
  for (const std::string text : {"{'time_ns': 0}", R"({"time_ns": 0})", R"({"error": 3})",
                                 R"({"time_ns": 0, "published": {"/scan": "one"}})",
                                 R"({"time_ns": 0, "published": {}, "subscribers": 2})"}) {
    EXPECT_THAT(error_of<TransportError>([&] { read_answer(text); }),
                wrong("/spikeloop/stepped", text));
  }
  EXPECT_THAT(
      error_of<TransportError>([] { read_answer(std::string(1000, 'x')); }),
      StartsWith("topic /spikeloop/stepped has brought '" + std::string(200, 'x') + "...'"));
}

TEST(Protocol, StringsAreThoseOfRos) {
  EXPECT_THAT(string_message(Dialect::ros1, "h\xC3\xA9"),
              ElementsAre(std::byte{3}, std::byte{0}, std::byte{0}, std::byte{0}, std::byte{'h'},
                          std::byte{0xC3}, std::byte{0xA9}));
  for (const Dialect ros : {Dialect::ros1, Dialect::ros2}) {
    const auto bytes = string_message(ros, "h\xC3\xA9");
    EXPECT_EQ(text_of(ros, bytes), "h\xC3\xA9");
    const std::string longer(70'000, 'z');
    EXPECT_EQ(text_of(ros, string_message(ros, longer)), longer);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_THROW(text_of(ros, std::span(bytes).first(size)), TransportError);
    }
  }
}

}  // namespace
}  // namespace spikeloop::stepping
