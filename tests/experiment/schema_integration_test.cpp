// `spikeloop schema`
#include <gmock/gmock.h>

#include "tests/experiment/program.hpp"

namespace spikeloop::test {
namespace {

TEST(Schema, TakesGoodFilesAndSeesWrongOnes) {
  const Outcome outcome =
      run({.arguments = {"/usr/bin/python3", "-B", CHECK_SCHEMA, SPIKELOOP_PROGRAM},
           .environment = {{"SPIKELOOP_PLUGIN_PATH", ""}}});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_THAT(outcome.out, testing::HasSubstr("wrong files are seen"));
}

TEST(Schema, SaysWhatKeysMean) {
  const TemporaryDirectory directory;
  const Outcome outcome = spikeloop({"schema"}, directory);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              testing::HasSubstr(
                  "Interval at which sensors, network and commands exchange data (default: 1 ms)"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("Topic to subscribe to (must be given)"));
}

}  // namespace
}  // namespace spikeloop::test
