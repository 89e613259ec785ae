// `spikeloop check` of experiment files: the words, the line, the caret, the exit code.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/experiment/program.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;

constexpr const char* kSmall = R"(experiment: small
duration: 10 ms
nodes:
  encoder: {node: rate_encoder, rate_max: 200}
  decoder: {node: linear_readout, tau: 30 mV, weights: uniform}
connections:
  - encoder -> decodr [3]
)";

TEST(Check, TellsEveryFaultWithItsLine) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", kSmall);
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(
      outcome.err,
      "error: x.yaml:4:43: node 'encoder': key 'rate_max': 200 has no unit; write for example  "
      "rate_max: 200 Hz\n"
      "    4 |   encoder: {node: rate_encoder, rate_max: 200}\n"
      "                                                  ^\n"
      "error: x.yaml:5:40: key 'tau': '30 mV': 'mV' is not a unit of time here; write one of: "
      "ns, us, ms, s, min, h\n"
      "    5 |   decoder: {node: linear_readout, tau: 30 mV, weights: uniform}\n"
      "                                               ^\n"
      "error: x.yaml:7:16: unknown node 'decodr' in 'decodr'; did you mean 'decoder'?\n"
      "    7 |   - encoder -> decodr [3]\n"
      "                       ^\n"
      "spikeloop: x.yaml: 3 errors\n");
}

TEST(Check, CaretStandsBelowCharactersNotBytes) {
  const TemporaryDirectory directory;
  directory.write("x.yaml",
                  "experiment: \"\xC3\xA4\xC3\xB6\xE2\x82\xAC\"  \nnodes:\n"
                  "  a: {node: sigmoid, note: \"\xC3\xA4\xE2\x82\xAC\", slope: 1 s}\n"
                  "connections: [\"a -> a [2, delay 1 tick]\"]\n");
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_THAT(outcome.err, HasSubstr("    3 |   a: {node: sigmoid, note: \"\xC3\xA4\xE2\x82\xAC\", "
                                     "slope: 1 s}\n" +
                                     std::string(8 + 40, ' ') + "^\n"));
}

TEST(Check, LongLinesAreCut) {
  const TemporaryDirectory directory;
  const std::string beams(300, '1');
  directory.write("x.yaml", "nodes:\n  a: {node: sigmoid, not_finite: hold, scale: " + beams +
                                ", slope: x, y_offset: " + beams +
                                "}\nconnections: [\"a -> a [2, delay 1 tick]\"]\n");
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_THAT(outcome.err,
              HasSubstr(" 'x' is not a number; write for example 0.5\n    2 | ... " +
                        std::string(51, '1') + ", slope: x, y_offset: " + std::string(77, '1') +
                        " ...\n" + std::string(72, ' ') + "^\n"));
}

TEST(Check, RunSaysTheFirstFaultAndHowManyMore) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", kSmall);
  const Outcome outcome = spikeloop({"run", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::StartsWith("spikeloop: x.yaml:4:43: node 'encoder': key "));
  EXPECT_THAT(outcome.err,
              testing::EndsWith("spikeloop: 2 errors more; see  spikeloop check x.yaml\n"));
}

TEST(Check, FilesThatCannotBeRead) {
  const TemporaryDirectory directory;
  const Outcome missing = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_EQ(missing.err,
            "error: cannot open 'x.yaml': No such file or directory\n"
            "spikeloop: x.yaml: 1 error\n");
  mkdir((directory.path() / "d.yaml").c_str(), 0755);
  const Outcome folder = spikeloop({"check", "d.yaml"}, directory);
  EXPECT_EQ(folder.exit_code, 4);
  EXPECT_THAT(folder.err, HasSubstr("error: cannot read 'd.yaml': Is a directory\n"));
  mkfifo((directory.path() / "f.yaml").c_str(), 0644);
  EXPECT_THAT(spikeloop({"check", "f.yaml"}, directory).err, HasSubstr("not a regular file"));
  directory.write("big.yaml", "#" + std::string(17'000'000, 'x'));
  const Outcome big = spikeloop({"check", "big.yaml"}, directory);
  EXPECT_EQ(big.exit_code, 2);
  EXPECT_THAT(big.err, HasSubstr("more than the 16 MB that a YAML file may have"));
}

TEST(Check, PluginsThatAreNotThere) {
  const TemporaryDirectory directory;
  directory.write("x.yaml",
                  "plugins: [mine.so]\nnodes: {a: {node: sigmoid}}\n"
                  "connections: [\"a -> a [2, delay 1 tick]\"]\n");
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("error: x.yaml:1:11: "));
  EXPECT_THAT(outcome.err, HasSubstr("mine.so"));
}

TEST(Check, WhatNewPrintsIsRight) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", spikeloop({"new", "maze"}, directory).out);
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "x.yaml: nothing to complain about: 6 nodes, 5 connections, tick 1 ms, 5 s\n");
}

}  // namespace
}  // namespace spikeloop::test
