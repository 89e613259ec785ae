#include "error_tail.hpp"

#include <gtest/gtest.h>

namespace spikeloop::launch {
namespace {

std::string text_of(const std::vector<std::pair<bool, std::string>>& lines) {
  ErrorTail words;
  for (const auto& [error, text] : lines) {
    words.take({std::nullopt, error, text});
  }
  return words.text();
}

TEST(ErrorTail, AreTheLastLineThatIsNotBlank) {
  EXPECT_EQ(text_of({}), "");
  EXPECT_EQ(text_of({{false, "begins"}, {false, "ends "}, {false, ""}, {false, " \t\r"}}), "ends");
  EXPECT_EQ(text_of({{true, "cannot"}, {false, "ends"}}), "cannot");
}

TEST(ErrorTail, HaveNoTerminalCodes) {
  EXPECT_EQ(text_of({{true, "\x1b[1;31mcannot\x1b[0m open"}, {true, "\x1b[0m"}}), "cannot open");
  EXPECT_EQ(text_of({{false, "done"}, {false, "\x1b]2;roscore\a"}}), "done");
  EXPECT_EQ(text_of({{false, "cut \x1b"}}), "cut");
  EXPECT_EQ(text_of({{false, "cut \x1b[31"}}), "cut");
}

// What a roscore prints that cannot resolve localhost.
TEST(ErrorTail, AreTheReasonThatRoslaunchGives) {
  EXPECT_EQ(text_of({{false, "Done checking log file disk usage. Usage is <1GB."},
                     {true,
                      "\x1b[31mRLException: Unable to contact my own server at "
                      "[http://localhost:33017/]."},
                     {true, "This usually means that the network is not configured properly."},
                     {true, ""},
                     {true, "\thttp://wiki.ros.org/ROS/NetworkSetup"},
                     {true, "\x1b[0m"},
                     {true,
                      "\x1b[31mThe traceback for the exception was written to the log "
                      "file\x1b[0m"}}),
            "Unable to contact my own server at [http://localhost:33017/]");
}

}  // namespace
}  // namespace spikeloop::launch
