// Parameters that are lists and maps.
#include <gtest/gtest.h>

#include <utility>

#include "spikeloop/core/parameters.hpp"
#include "support.hpp"

namespace spikeloop::nested_parameters_test {
namespace {

using test::Fault;
using test::message_of;
using Entries = std::vector<WrittenEntry>;

constexpr ParameterType kList = ParameterType::list;
constexpr ParameterType kMap = ParameterType::map;

WrittenValue plain(const std::string& text, int line = 1) {
  return {text, {"f", line, 1}};
}
WrittenValue list(Entries entries, const std::string& text = "[...]") {
  return {text, {"f", 1, 1}, [entries = std::move(entries)] { return entries; }};
}
WrittenValue map(Entries entries) {
  return list(std::move(entries), "{...}");
}

/// pair: [1, 2]; stop: a topic, or {topic, timeout}; bounds: none, or {FIELD: [1, 2]}; fields: a
/// list of paths, or of {path, scale}.
std::vector<ParameterDescription> declared() {
  const ParameterDescription pair{.name = "pair",
                                  .type = kList,
                                  .default_value = "",
                                  .inner = {{.name = "end", .minimum = 0}},
                                  .count = 2,
                                  .example = "[1, 2]"};
  ParameterDescription any = pair;
  any.name = kAnyKey;
  return {pair,
          {.name = "stop",
           .type = kMap,
           .default_value = "/stop",
           .inner = {{.name = "topic", .type = ParameterType::text, .default_value = "/other"},
                     {.name = "timeout", .unit = "s", .default_value = "1 s"}},
           .plain_key = "topic",
           .example = "{topic: /a}"},
          {.name = "bounds",
           .type = kMap,
           .default_value = "",
           .choices = {"none"},
           .inner = {any},
           .example = "{a: [1, 2]}"},
          {.name = "fields",
           .type = kList,
           .default_value = "",
           .inner = {{.name = "fields",
                      .type = kMap,
                      .inner = {{.name = "path", .type = ParameterType::text, .text = "where"},
                                {.name = "scale", .default_value = "1"},
                                {.name = "least", .default_value = ""}},
                      .plain_key = "path",
                      .example = "[{path: a}]"}},
           .example = "[a]"}};
}

Parameters read(const std::string& key, const WrittenValue& value) {
  return resolve(declared(), {{key, value}}, {});
}
std::string error_of(const std::string& key, const WrittenValue& value) {
  return message_of<ConfigurationError>([&] { read(key, value); });
}

TEST(NestedParameters, ListsOfNumbers) {
  const std::vector<double> both{3, 4.5};
  EXPECT_EQ(read("pair", list({{"", plain("3")}, {"", plain("4.5")}})).numbers("pair"), both);
  EXPECT_EQ(read("pair", plain("3, 4.5")).numbers("pair"), both);
  EXPECT_EQ(read("pair", plain("[3,4.5]")).numbers("pair"), both);
  EXPECT_TRUE(resolve(declared(), {}, {}).numbers("pair").empty());
}

TEST(NestedParameters, AMapHasItsDefaultsAndAShortForm) {
  EXPECT_EQ(resolve(declared(), {}, {}).map("stop").text("topic"), "/stop");
  EXPECT_EQ(read("stop", plain("/a")).map("stop").text("topic"), "/a");
  const Parameters keys = read("stop", map({{"timeout", plain("20 ms", 7)}}));
  EXPECT_EQ(keys.map("stop").text("topic"), "/other");
  EXPECT_EQ(keys.map("stop").number("timeout"), 0.02);
  EXPECT_EQ(keys.map("stop").where("timeout").line, 7);
  EXPECT_TRUE(keys.map("stop").given("timeout"));
  EXPECT_FALSE(keys.map("stop").given("topic"));
}

TEST(NestedParameters, KeysOfTheUsersOwnKeepTheirOrder) {
  const WrittenValue pair = plain("1,2");
  const Parameters keys = read("bounds", map({{"b", pair}, {"a", plain("3,4", 5)}}));
  ASSERT_EQ(keys.entries("bounds").size(), 2U);
  EXPECT_EQ(keys.entries("bounds")[0].key, "b");
  EXPECT_EQ(keys.entries("bounds")[1].values.numbers(kAnyKey), (std::vector<double>{3, 4}));
  EXPECT_EQ(keys.entries("bounds")[1].where.line, 5);
  EXPECT_EQ(keys.word("bounds"), "");
  EXPECT_EQ(read("bounds", plain("none")).word("bounds"), "none");
  EXPECT_TRUE(read("bounds", plain("none")).entries("bounds").empty());
}

TEST(NestedParameters, ListsOfMaps) {
  const Parameters keys = read(
      "fields", list({{"", plain("x")}, {"", map({{"path", plain("y")}, {"scale", plain("2")}})}}));
  ASSERT_EQ(keys.entries("fields").size(), 2U);
  EXPECT_EQ(keys.entries("fields")[0].values.text("path"), "x");
  EXPECT_EQ(keys.entries("fields")[0].values.number("scale"), 1);
  EXPECT_EQ(keys.entries("fields")[1].values.number("scale"), 2);
  EXPECT_FALSE(keys.entries("fields")[1].values.given("least"));
  EXPECT_EQ(read("fields", plain("x,y")).entries("fields").size(), 2U);
}

TEST(NestedParameters, WhatIsWrongHasItsPlace) {
  EXPECT_THAT(error_of("pair", plain("1")),
              Fault("f:1:1: key 'pair': '1' ... 2 ... pair: [1, 2] ... [SL0105]"));
  EXPECT_THAT(error_of("pair", plain("")),
              Fault("f:1:1: key 'pair': '' ... 2 ... pair: [1, 2] ... [SL0105]"));
  EXPECT_THAT(error_of("pair", map({})),
              Fault("f:1:1: key 'pair': '{...}' ... pair: [1, 2] ... [SL0105]"));
  EXPECT_THAT(error_of("pair", list({{"", plain("1")}, {"", plain("-1", 4)}})),
              Fault("f:4:1: key 'pair': entry 2: -1 ... 0 ... [SL0203]"));
  EXPECT_EQ(error_of("stop", list({})),
            "f:1:1: key 'stop': '[...]' is not a map; write  stop: {topic: /a} [SL0105]");
  EXPECT_EQ(error_of("stop", map({{"tpic", plain("/a", 3)}})),
            "f:3:1: key 'stop': unknown key 'tpic'; did you mean 'topic'? [SL0103]");
  EXPECT_EQ(
      error_of("stop", map({{"timeout", plain("2", 3)}})),
      "f:3:1: key 'stop': key 'timeout': 2 has no unit; write for example  timeout: 2 s [SL0202]");
  EXPECT_EQ(error_of("bounds", plain("all")),
            "f:1:1: key 'bounds': 'all' is neither none nor a map; write  none, or a map such as  "
            "bounds: {a: [1, 2]} [SL0105]");
  EXPECT_THAT(error_of("bounds", map({{"a", plain("5", 2)}})),
              Fault("f:2:1: key 'bounds': 'a': '5' ... 2 ... [1, 2] ... [SL0105]"));
  EXPECT_EQ(error_of("fields", list({{"", map({{"scale", plain("2")}})}})),
            "f:1:1: key 'fields': entry 1: key 'path' is missing (where); write  fields: [{path: "
            "a}] [SL0104]");
}

}  // namespace
}  // namespace spikeloop::nested_parameters_test
