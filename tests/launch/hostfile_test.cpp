// Open MPI's file of hosts, before mpirun reads it.
#include "spikeloop/launch/hostfile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::launch {
namespace {

using test::Fault;

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
  EXPECT_THAT(problem("robot slots=four\n"),
              Fault(":1: 'slots=four' ... Open MPI's ... robot slots=4 ... [SL0103]"));
  EXPECT_THAT(problem("{\"hosts\": 3}\n"),
              Fault(":1: '{\"hosts\":' ... robot slots=4 ... [SL0106]"));
  EXPECT_THAT(problem("localhost:4\n"), Fault(":1: 'localhost:4' ... robot slots=4 ... [SL0106]"));
  EXPECT_EQ(
      problem("a slots=2\nb\na slots=2\n"),
      ":3: the host 'a' stands in line 1 already; write it once, with all its slots [SL0107]");
  EXPECT_THAT(problem("a slots=2\r\n"),
              testing::StartsWith(":1: the line ends as on Windows; write  sed -i 's/\\r$//' "));
  EXPECT_THAT(problem("# nobody\n"),
              Fault(": the hostfile names no host ... robot slots=4 ... [SL0104]"));
}

TEST(Hostfile, MustBeReadable) {
  const test::TemporaryDirectory directory;
  const std::string folder = directory.path().string();
  try {
    check_hostfile(folder + "/hosts");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(),
                Fault("cannot open the hostfile '" + folder + "/hosts': ... [SL0109]"));
    EXPECT_EQ(error.exit_code(), 4);
  }
  EXPECT_THROW(check_hostfile(folder), FileError);
  EXPECT_THROW(check_hostfile("/dev/zero"), FileError) << "which has no end";
}

}  // namespace
}  // namespace spikeloop::launch
