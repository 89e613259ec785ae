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
      "rate_max: 200 Hz [SL0202]\n"
      "    4 |   encoder: {node: rate_encoder, rate_max: 200}\n"
      "                                                  ^\n"
      "error: x.yaml:5:40: key 'tau': '30 mV': 'mV' is not a unit of time here; write one of: "
      "ns, us, ms, s, min, h [SL0202]\n"
      "    5 |   decoder: {node: linear_readout, tau: 30 mV, weights: uniform}\n"
      "                                               ^\n"
      "error: x.yaml:7:16: unknown node 'decodr'; did you mean 'decoder'? [SL0301]\n"
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
              HasSubstr(" 'x' is not a number; write for example 0.5 [SL0201]\n    2 | ... " +
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

// What `run` would refuse of simulators beside the fused layout, `check` does: in the same words.
TEST(Check, TellsWhatTheFusedLayoutRefusesOfSimulators) {
  const TemporaryDirectory directory;
  directory.write("brain.py", "import spikeloop\n");
  directory.write("x.yaml",
                  "nodes:\n  a: {simulator: python, script: brain.py}\n"
                  "  b: {simulator: python, script: brain.py}\nconnections:\n  - a -> b [10]\n");
  const std::string said =
      ": x.yaml:2:3: no connection joins the simulators with the other nodes, which one process "
      "has in the fused layout, and MUSIC would wait forever; connect them, or use --layout "
      "separate [SL0305]\n    2 |   a: {simulator: python, script: brain.py}\n          ^\n";
  const Outcome checked = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(checked.exit_code, 2);
  EXPECT_EQ(checked.out, "");
  EXPECT_EQ(checked.err, "error" + said + "spikeloop: x.yaml: 1 error\n");
  const Outcome ran = spikeloop({"run", "x.yaml"}, directory);
  EXPECT_EQ(ran.exit_code, 2);
  EXPECT_EQ(ran.err, "spikeloop" + said);
}

TEST(Check, FilesThatCannotBeRead) {
  const TemporaryDirectory directory;
  const Outcome missing = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_EQ(missing.err,
            "error: cannot open 'x.yaml': No such file or directory [SL0109]\n"
            "spikeloop: x.yaml: 1 error\n");
  mkdir((directory.path() / "d.yaml").c_str(), 0755);
  const Outcome folder = spikeloop({"check", "d.yaml"}, directory);
  EXPECT_EQ(folder.exit_code, 4);
  EXPECT_THAT(folder.err, HasSubstr("error: cannot read 'd.yaml': Is a directory [SL0109]\n"));
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

TEST(Check, AClassThatAPluginWouldHaveBroughtIsNotSaidToBeUnknown) {
  const TemporaryDirectory directory;
  directory.write("broken.py", "import spikeloop\n@spikeloop.node\nclass Mine(:\n");
  directory.write("x.yaml",
                  "plugins: [broken.py]\nnodes: {a: {node: mine}, b: {node: sigmoid, slop: 1}}\n"
                  "connections: [\"a -> b [2] -> a [2, delay 1 tick]\"]\n");
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("error: x.yaml:1:11: ./broken.py:3: "));
  EXPECT_THAT(outcome.err, HasSubstr("unknown key 'slop'; did you mean 'slope'?"));
  EXPECT_THAT(outcome.err, testing::EndsWith("spikeloop: x.yaml: 2 errors\n"));
}

TEST(Check, ADirectoryInPlaceOfAFile) {
  const TemporaryDirectory directory;
  mkdir((directory.path() / "out").c_str(), 0755);
  directory.write("x.yaml",
                  "nodes: {a: {node: connect, weights: out}}\n"
                  "connections: [\"a -> a [2, delay 1 tick]\"]\n");
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("error: x.yaml:1:37: key 'weights': cannot read './out': Is a "
                                     "directory; write the path of a file [SL0108]\n"));
}

TEST(Check, PathsStartWhereALinkLies) {
  const TemporaryDirectory directory;
  for (const char* name : {"there", "here"}) {
    std::filesystem::create_directory(directory.path() / name);
  }
  directory.write("there/x.yaml",
                  "nodes: {a: {node: connect, weights: w.json}}\n"
                  "connections: [a -> a]\n");
  std::filesystem::create_symlink("../there/x.yaml", directory.path() / "here/x.yaml");
  directory.write("there/w.json", "[[1]]");
  EXPECT_THAT(spikeloop({"check", "here/x.yaml"}, directory).err,
              HasSubstr("here/x.yaml:1:37: key 'weights': there is no weight file 'w.json' in "));
  directory.write("here/w.json", "[[1, 0], [0, 1]]");
  EXPECT_THAT(spikeloop({"check", "here/x.yaml"}, directory).err,
              HasSubstr("the cycle a -> a has no delay"));
}

/// What `spikeloop new` prints, with a part of it replaced.
std::string new_with(const TemporaryDirectory& directory, const std::string& node,
                     const std::string& other) {
  std::string text = spikeloop({"new"}, directory).out;
  const auto place = text.find(node);
  EXPECT_NE(place, std::string::npos) << node;
  return text.replace(place, node.size(), other);
}

TEST(Check, SensorsHaveTheWidthOfTheRobot) {
  const TemporaryDirectory directory;
  const std::string chain =
      "sectors [100] -> encoder [10] -> brain [10] -> decoder [10] -> wheels [2]";
  directory.write("x.yaml", new_with(directory, chain,
                                     "sectors [90] -> encoder -> brain -> decoder "
                                     "-> wheels"));
  const Outcome narrow = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(narrow.exit_code, 2);
  EXPECT_THAT(narrow.err,
              testing::ContainsRegex("error: x.yaml:[0-9]+:13: node 'scan': a message of the "
                                     "robot's topic /scan gives 100 values, but 'scan.out' has 90 "
                                     "channels; write \\[100\\] in its connection \\[SL0505\\]\n"));
  directory.write("x.yaml", new_with(directory, chain,
                                     "sectors -> encoder -> brain -> decoder -> "
                                     "wheels"));
  EXPECT_EQ(spikeloop({"check", "x.yaml"}, directory).err, "");
  directory.write("x.yaml",
                  new_with(directory, "message: sensor_msgs/LaserScan",
                           "message: sensor_msgs/LaserScan, fields: [ranges, range_max]"));
  EXPECT_THAT(spikeloop({"check", "x.yaml"}, directory).err, HasSubstr("gives 101 values, but"));
  directory.write("x.yaml", new_with(directory, chain,
                                     "sectors [90] -> encoder -> brain -> decoder "
                                     "-> wheels\nros: 1"));
  EXPECT_THAT(spikeloop({"check", "x.yaml"}, directory).err,
              HasSubstr("in its connection, or leave 'robot' out when another robot sends it"));
}

TEST(Check, AWorldThatIsNotThere) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", new_with(directory, "world: arena.xml", "world: maze.xml"));
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err,
              testing::ContainsRegex("error: x.yaml:[0-9]+:35: cannot find world 'maze.xml'"));
}

/// A program checks its section.
TEST(Export, SpeaksOfTheExperimentsLines) {
  const TemporaryDirectory directory;
  directory.write("x.yaml",
                  "ros: 1\nnodes:\n  a: {node: ros_sensor, topic: /a, message: Twist}\n"
                  "  b: {node: ros_command, topic: /c, message: Float64MultiArray,\n"
                  "      command_rate: 1e-300 Hz}\n"
                  "connections:\n  - a -> b [2]\n");
  const Outcome outcome = spikeloop({"export", "x.yaml", "--out", "job"}, directory);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::StartsWith("spikeloop: x.yaml:4:3: a time of "));
}

TEST(Export, WhatIsRefusedLeavesNoFolder) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", spikeloop({"new"}, directory).out);
  const Outcome outcome = spikeloop({"export", "x.yaml", "--out", "jobs/job"}, directory);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("an exported job reaches the robot over ROS"));
  EXPECT_FALSE(std::filesystem::exists(directory.path() / "jobs"));
}

TEST(Run, TimeoutsAreForSeveralProcesses) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", spikeloop({"new"}, directory).out);
  const Outcome outcome = spikeloop({"run", "x.yaml", "--stall-timeout", "5"}, directory);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "spikeloop: --stall-timeout is for runs in several processes (layout,  ros,  a "
            "simulator), and this one has a single process; leave it out\n");
}

TEST(Check, WhatNewPrintsIsRight) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", spikeloop({"new", "maze"}, directory).out);
  const Outcome outcome = spikeloop({"check", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "x.yaml: OK: 6 nodes, 5 connections, tick 1 ms, 5 s\n");
}

TEST(Check, SaysWhatAFileOfAnotherKindIs) {
  const TemporaryDirectory directory;
  directory.write("brain.py", "import spikeloop\n");
  directory.write("net.yaml", "populations:\n  input: {model: input, size: 3}\noutput: [input]\n");
  for (const char* command : {"check", "run"}) {
    EXPECT_EQ(
        spikeloop({command, "brain.py"}, directory).err,
        "spikeloop: 'brain.py' is a script, not an experiment; write in an experiment  brain: "
        "{simulator: python, script: brain.py},  or  network: brain.py:FUNCTION [SL0105]\n");
    EXPECT_THAT(spikeloop({command, "net.yaml"}, directory).err,
                testing::HasSubstr("net.yaml: this is a network, not an experiment; write in an "
                                   "experiment  brain: {simulator: builtin, network: net.yaml}"));
  }
}

}  // namespace
}  // namespace spikeloop::test
