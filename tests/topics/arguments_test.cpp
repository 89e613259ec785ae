#include "spikeloop/topics/arguments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using spikeloop::test::Fault;

namespace test = spikeloop::test;
namespace messages = spikeloop::messages;
using namespace spikeloop::topics;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

TEST(CommandLine, arguments_for_ros_are_told_by_their_sign) {
  const char* const argv[] = {"robot", "--seed", "3", "__name:=left", "/scan:=/left/scan", "x="};
  const CommandLine line = split_command_line(6, argv);
  EXPECT_THAT(line.own, ElementsAre("robot", "--seed", "3", "x="));
  EXPECT_THAT(line.ros, ElementsAre(Pair("/scan", "/left/scan"), Pair("__name", "left")));
}

TEST(CommandLine, arguments_for_ros2_stand_behind_a_sign) {
  const char* const argv[] = {"robot",      "--ros-args", "-r",   "__node:=left", "--remap",
                              "scan:=beam", "-p",         "a:=1", "--log-level",  "info",
                              "--",         "--seed",     "3"};
  const CommandLine line = split_command_line(13, argv);
  EXPECT_THAT(line.own, ElementsAre("robot", "--seed", "3"));
  EXPECT_THAT(line.ros, ElementsAre(Pair("__name", "left"), Pair("scan", "beam")));
  EXPECT_THAT(line.foreign, ElementsAre("-p a:=1", "--log-level info"));
  const char* const without_end[] = {"robot", "-r", "--ros-args", "-e", "/enclave"};
  EXPECT_THAT(split_command_line(5, without_end).own, ElementsAre("robot", "-r"));
  EXPECT_THAT(split_command_line(5, without_end).ros, IsEmpty());
  const char* const twice[] = {"--ros-args", "stray",      "-r", "a:=b", "-p",
                               "c:=1",       "--ros-args", "-r", "c:=d"};
  EXPECT_THAT(split_command_line(9, twice).ros, ElementsAre(Pair("a", "b"), Pair("c", "d")));
  EXPECT_THAT(split_command_line(9, twice).foreign, ElementsAre("stray", "-p c:=1"));
}

TEST(CommandLine, use_sim_time_is_understood) {
  const auto line_of = [](std::vector<const char*> words) {
    words.insert(words.begin(), {"robot", "--ros-args"});
    return split_command_line(static_cast<int>(words.size()), words.data());
  };
  EXPECT_EQ(line_of({"-p", "use_sim_time:=true"}).use_sim_time, true);
  EXPECT_EQ(line_of({"--param", "use_sim_time:=false"}).use_sim_time, false);
  EXPECT_THAT(line_of({"-p", "use_sim_time:=true"}).foreign, IsEmpty());
  EXPECT_THAT(line_of({"-p", "use_sim_time:=1"}).foreign, ElementsAre("-p use_sim_time:=1"));
  EXPECT_EQ(line_of({"-p", "rate:=1"}).use_sim_time, std::nullopt);
  const test::TemporaryDirectory directory;
  const std::string all =
      directory.write("launch_params", "/**:\n  ros__parameters:\n    use_sim_time: true\n");
  EXPECT_EQ(line_of({"--params-file", all.c_str()}).use_sim_time, true);
  const std::string more =
      directory.write("more", "/**:\n  ros__parameters:\n    use_sim_time: true\n    rate: 5\n");
  EXPECT_EQ(line_of({"--params-file", more.c_str()}).use_sim_time, std::nullopt);
  EXPECT_THAT(line_of({"--params-file", more.c_str()}).foreign,
              ElementsAre("--params-file " + more));
}

TEST(CommandLine, options_keep_their_values) {
  const char* const argv[] = {"run", "--robot-arg=/scan:=/front/scan", ":=x"};
  EXPECT_THAT(split_command_line(3, argv).own, ElementsAre("run", argv[1], argv[2]));
}

std::string error_of_remap(std::initializer_list<const char*> words) {
  std::vector<const char*> argv{"robot", "--ros-args"};
  argv.insert(argv.end(), words);
  return test::error_of([&] { split_command_line(static_cast<int>(argv.size()), argv.data()); });
}

TEST(CommandLine, a_rule_gives_a_name) {
  const std::string advice =
      " (behind --ros-args) gives no name; write -r NAME:=VALUE, as in -r /scan:=/front/scan "
      "[SL0510]";
  EXPECT_EQ(error_of_remap({"-r", "scan"}), "'-r scan'" + advice);
  EXPECT_EQ(error_of_remap({"--remap"}), "'-r'" + advice);
}

TEST(RosArguments, are_written_and_read_back) {
  const RosArguments arguments{{"/scan", "/front/scan"}, {"__ns", "/arena"}};
  EXPECT_EQ(to_text(arguments), "/scan:=/front/scan __ns:=/arena");
  EXPECT_EQ(read_ros_arguments(" " + to_text(arguments) + "\n"), arguments);
  EXPECT_THAT(read_ros_arguments(""), IsEmpty());
  EXPECT_EQ(test::error_of([] { read_ros_arguments("a:=b c"); }),
            "'c' is not an argument of ROS; write NAME:=VALUE, as in /scan:=/front/scan [SL0510]");
}

std::string error_of_names(messages::Dialect ros, const char* text) {
  return test::error_of([&] { check_ros_arguments(ros, read_ros_arguments(text)); });
}

TEST(RosArguments, have_names_of_their_ros) {
  using messages::Dialect;
  for (const Dialect ros : {Dialect::ros1, Dialect::ros2}) {
    check_ros_arguments(ros, read_ros_arguments("scan:=/front/scan __ns:=arena __name:=brain"));
    EXPECT_EQ(error_of_names(ros, "__log:=/tmp"),
              "'__log:=/tmp' means nothing here: topics have other names by NAME:=VALUE, as "
              "/scan:=/front/scan, and the node by __ns and __name; leave it out [SL0510]");
    EXPECT_THAT(error_of_names(ros, "__name:=a/b"),
                Fault("... 'a/b' ... ROS node name ... [SL0501] ..."));
    EXPECT_THAT(error_of_names(ros, "__ns:=a-b"), Fault("... '/a-b' ... [SL0501] ..."));
    EXPECT_THAT(error_of_names(ros, "/scan:=/a-b"), Fault("... '/a-b' ... [SL0501] ..."));
    EXPECT_THAT(error_of_names(ros, "a-b:=/scan"), Fault("... 'a-b' ... [SL0501] ..."));
  }
  // A rule for one node alone.
  check_ros_arguments(Dialect::ros2, read_ros_arguments("brain:scan:=/front/scan"));
}

TEST(RosArguments, give_a_topic_another_name) {
  const auto name = [](const char* text) { return renamed("/scan", read_ros_arguments(text)); };
  EXPECT_EQ(name(""), "/scan");
  EXPECT_EQ(name("/odom:=/x __ns:=/arena"), "/scan");
  EXPECT_EQ(name("/scan:=/front/scan"), "/front/scan");
  EXPECT_EQ(name("scan:=front/scan"), "/front/scan");
  EXPECT_EQ(name("scan:=front/scan __ns:=/"), "/front/scan");
  EXPECT_EQ(name("/scan:=beam __ns:=/arena"), "/arena/beam");
  EXPECT_EQ(name("/scan:=beam __ns:=arena"), "/arena/beam");
  EXPECT_EQ(name("scan:=beam __ns:=/arena"), "/scan");
}

}  // namespace
