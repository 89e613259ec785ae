// Open MPI's file of hosts, before mpirun reads it.
#include "spikeloop/launch/hostfile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::launch {
namespace {

/// What is wrong with a hostfile of this text, without its path.
std::string problem(const std::string& text) {
  const test::TemporaryDirectory directory;
  const std::string path = directory.write("hosts", text);
  try {
    check_hostfile(path);
    return "";
  } catch (const ConfigurationError& error) {
    return std::string(error.what()).substr(path.size());
  }
}

TEST(Hostfile, TakesWhatOpenMpiTakes) {
  EXPECT_EQ(problem("# ours\nlocalhost slots=4 max_slots=8\n\nme@robot.lab  # the other\n"), "");
  EXPECT_EQ(problem("10.0.0.1 username=me\nfe80::1 slots=2"), "");
  EXPECT_EQ(
      problem("localhost slots = 4 // ours\n/* not\n these */ robot 4\nrobot\n+n0 cpu-max=2\n"),
      "");
}

TEST(Hostfile, NamesTheLineThatMpirunWouldNotUnderstand) {
  EXPECT_EQ(problem("localhost\nrobot slot=4\n"),
            ":2: 'slot=4' is none of Open MPI's options of a host; write a line like  robot "
            "slots=4 [SL0103]");
  EXPECT_EQ(problem("robot slots=four\n"),
            ":1: 'slots=four' is none of Open MPI's options of a host; write a line like  robot "
            "slots=4 [SL0103]");
  EXPECT_EQ(
      problem("{\"hosts\": 3}\n"),
      ":1: '{\"hosts\":' is not a valid host name; write a line like  robot slots=4 [SL0106]");
  EXPECT_EQ(
      problem("localhost:4\n"),
      ":1: 'localhost:4' is not a valid host name; write a line like  robot slots=4 [SL0106]");
  EXPECT_EQ(
      problem("a slots=2\nb\na slots=2\n"),
      ":3: the host 'a' stands in line 1 already; write it once, with all its slots [SL0107]");
  EXPECT_THAT(problem("a slots=2\r\n"),
              testing::StartsWith(":1: the line ends as on Windows; write  sed -i 's/\\r$//' "));
  EXPECT_EQ(problem("# nobody\n"),
            ": the hostfile names no host; write a line like  robot slots=4 [SL0104]");
}

TEST(Hostfile, MustBeReadable) {
  const test::TemporaryDirectory directory;
  const std::string folder = directory.path().string();
  try {
    check_hostfile(folder + "/hosts");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.what(), "cannot open the hostfile '" + folder +
                                "/hosts': No such file or directory [SL0109]");
    EXPECT_EQ(error.exit_code(), 4);
  }
  EXPECT_THROW(check_hostfile(folder), FileError);
  EXPECT_THROW(check_hostfile("/dev/zero"), FileError) << "which has no end";
}

}  // namespace
}  // namespace spikeloop::launch
