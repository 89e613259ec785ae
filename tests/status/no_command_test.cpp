#include "spikeloop/status/no_command.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace no_command_test {
namespace {

using nlohmann::json;
using spikeloop::status::find_no_command;

json run(json sensor, json command) {
  json counters{{"encoder.spikes", 7U}};
  for (const auto& [name, value] : sensor.items()) {
    counters["scan." + name] = value;
  }
  for (const auto& [name, value] : command.items()) {
    counters["wheels." + name] = value;
  }
  return counters;
}

const json kUnreadable{{"messages", 20U}, {"malformed", 3U}, {"without_reading", 17U}};
const json kReadable{{"messages", 20U}, {"malformed", 3U}, {"without_reading", 16U}};
const json kSilent{{"messages", 0U}, {"malformed", 0U}};
const json kNone{
    {"commands", 0U}, {"overrides", 0U}, {"stops_sensor_silent", 0U}, {"stops_ended", 1U}};

TEST(NoCommand, a_run_with_commands_has_none) {
  EXPECT_FALSE(find_no_command(
      run(kUnreadable, {{"commands", 1U}, {"overrides", 0U}, {"stops_sensor_silent", 0U}})));
  EXPECT_FALSE(find_no_command(
      run(kUnreadable, {{"commands", 0U}, {"overrides", 1U}, {"stops_sensor_silent", 0U}})));
  EXPECT_FALSE(find_no_command(json::object()));
}

TEST(NoCommand, unreadable_messages_are_a_failure) {
  const auto found = find_no_command(run(kUnreadable, kNone));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->nothing_usable);
  EXPECT_EQ(found->reason,
            "no command was sent: none of the 20 messages of 'scan' was usable (malformed: 3, "
            "without_reading: 17)");
}

TEST(NoCommand, other_causes_are_no_failure) {
  const auto silent = find_no_command(run(kSilent, kNone));
  ASSERT_TRUE(silent);
  EXPECT_FALSE(silent->nothing_usable);
  EXPECT_EQ(silent->reason, "no command was sent: no message of 'scan' arrived");
  json stopped = kNone;
  stopped["stops_emergency_stop"] = 2U;
  EXPECT_EQ(find_no_command(run(kReadable, stopped))->reason,
            "no command was sent: the robot was stopped (stops_emergency_stop)");
  EXPECT_EQ(find_no_command(run(kReadable, kNone))->reason,
            "no command was sent: the nodes before the command gave no value");
}

TEST(NoCommand, a_run_without_commands_needs_one_usable_message) {
  EXPECT_TRUE(find_no_command(run(kUnreadable, json::object()))->nothing_usable);
  EXPECT_FALSE(find_no_command(run(kReadable, json::object())));
  EXPECT_FALSE(find_no_command(run(kSilent, json::object())));
  json two = run(kUnreadable, json::object());
  two["odom.messages"] = 1U;
  two["odom.malformed"] = 0U;
  EXPECT_FALSE(find_no_command(two));
}

}  // namespace
}  // namespace no_command_test
