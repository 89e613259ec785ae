#include "spikeloop/topics/arguments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

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
  const char* const without_end[] = {"robot", "-r", "--ros-args", "-e", "/enclave"};
  EXPECT_THAT(split_command_line(5, without_end).own, ElementsAre("robot", "-r"));
  EXPECT_THAT(split_command_line(5, without_end).ros, IsEmpty());
}

}  // namespace
