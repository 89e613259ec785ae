// Python nodes in programs: under the real mpirun and MUSIC, and in what describes them.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "job.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// 50 rows, 10 ms each, of three channels.
std::string rows() {
  std::string text;
  for (int i = 0; i < 50; ++i) {
    text += std::to_string(10 * i);
    for (const int factor : {7, 13, 29}) {
      text += " " + std::to_string((i * factor % 41 - 20) / 20.0);
    }
    text += "\n";
  }
  return text;
}

TEST(PythonJob, TheExamplesEncoderSpikesAsTheBuiltInOne) {
  Job job;
  std::filesystem::copy(ENCODER_FILE, job.directory.path() / "encoder.py");
  job.global("stoptime=0.5").global("record=true").global("rate_max=333").global("rate_min=5");
  job.raw("sink")
      .raw("second")
      .ours("theirs", "rate_encoder")
      .ours("mine", "spikeloop-node", "node=my_rate_encoder\nplugin=encoder.py")
      .raw("source", "values=" + job.directory.write("values.txt", rows()))
      .connect("source.values -> theirs.in [3]")
      .connect("source.values -> mine.in [3]")
      .connect("theirs.out -> sink.spikes_in [3]")
      .connect("mine.out -> second.spikes_in [3]");
  auto command = job.command();
  command.environment["SPIKELOOP_OUT"] = job.directory.path().string();
  command.directory = "/tmp";  // plugin= is looked for beside the file, as weights are
  expect_clean(test::run(command));
  const auto theirs = record::read_spikes((job.directory.path() / "theirs.h5").string(), "out");
  const auto mine = record::read_spikes((job.directory.path() / "mine.h5").string(), "out");
  ASSERT_GT(theirs.spikes.size(), 200U);
  ASSERT_EQ(mine.spikes.size(), theirs.spikes.size());
  for (std::size_t i = 0; i < theirs.spikes.size(); ++i) {
    EXPECT_EQ(mine.spikes[i].channel, theirs.spikes[i].channel) << i;
    EXPECT_LE(std::abs(mine.spikes[i].time_ns - theirs.spikes[i].time_ns), 1) << i;
  }
}

/// A job of one node, `It` in nodes.py, whose class has this body.
Outcome run_it(const std::string& body, const std::string& keys = "") {
  Job job;
  job.directory.write("nodes.py",
                      "import spikeloop\n"
                      "@spikeloop.node\n"
                      "class It:\n"
                      "    outputs = {'out': spikeloop.Spikes(width=1)}\n"
                      "    rate = spikeloop.Parameter(10, unit='Hz', minimum=1)\n" +
                          body);
  job.global("stoptime=0.02");
  job.raw("sink")
      .ours("cell", "spikeloop-node", "node=it\nplugin=nodes.py\n" + keys)
      .connect("cell.out -> sink.spikes_in [1]");
  return job.run();
}

TEST(PythonJob, AnExceptionEndsTheRunWithItsPlaceAndTheTraceback) {
  const Outcome outcome = run_it("    def step(self, step):\n        1 / step.begin\n");
  EXPECT_EQ(outcome.exit_code, 5) << outcome.text();
  EXPECT_TRUE(outcome.says("cell: node 'cell': ")) << outcome.text();
  EXPECT_TRUE(outcome.says("nodes.py:7: in step: ZeroDivisionError: division by zero [SL0704]\n"));
  EXPECT_TRUE(outcome.says("cell: warning: Traceback (most recent call last):\n"));
  EXPECT_TRUE(outcome.says("cell: warning:     1 / step.begin\n"));
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(PythonJob, AnExceptionInCountersDoes) {
  const Outcome outcome = run_it(
      "    def step(self, step): ...\n"
      "    def counters(self): raise KeyError('a')\n");
  EXPECT_EQ(outcome.exit_code, 5) << outcome.text();
  EXPECT_TRUE(outcome.says("nodes.py:7: in counters: KeyError: 'a' [SL0704]\n")) << outcome.text();
}

TEST(PythonJob, AnExceptionInInitIsAnErrorOfTheSection) {
  const Outcome outcome = run_it(
      "    def __init__(self): raise ValueError('no')\n"
      "    def step(self, step): ...\n");
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text();
  EXPECT_TRUE(outcome.says("'cell': ")) << outcome.text();
  EXPECT_TRUE(outcome.says("nodes.py:6: in __init__: ValueError: no [SL0402]\n")) << outcome.text();
}

TEST(PythonJob, ParametersAreCheckedAsAllOthers) {
  const Outcome outcome = run_it("    def step(self, step): ...\n", "rate=0 Hz");
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text();
  EXPECT_TRUE(outcome.says("key 'rate': ")) << outcome.text();
}

TEST(PythonJob, WhatItPrintsIsSeen) {
  const Outcome outcome = run_it(
      "    def step(self, step):\n"
      "        if step.begin == 0: print('I am alive')\n");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_TRUE(outcome.says("I am alive\n")) << outcome.text();
}

Outcome describe(const std::string& name, const std::map<std::string, std::string>& environment) {
  Command command;
  command.arguments = {std::string(PROGRAMS) + "/spikeloop", "describe", name};
  command.environment = environment;
  return run(command);
}

TEST(PythonDescribe, ShowsANodeOfAFile) {
  const std::string directory = std::filesystem::path(ENCODER_FILE).parent_path();
  const Outcome outcome = describe("my_rate_encoder", {{"SPIKELOOP_PLUGIN_PATH", directory}});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "my_rate_encoder: Turns each value into regular spikes at a proportional rate\n"
            "Source: " ENCODER_FILE
            "\n\n"
            "Ports:\n"
            "  in   input   continuous  any width      Values in [-1, 1], one a channel\n"
            "  out  output  spikes      as wide as in  One neuron a channel\n\n"
            "Parameters:\n"
            "  rate_min  Hz  0    >= 0  Firing rate at the input value -1\n"
            "  rate_max  Hz  100  >= 0  Firing rate at the input value 1\n\n"
            "In an experiment: my_rate_encoder: {node: my_rate_encoder}. In a .music file: "
            "binary=spikeloop-node with node=my_rate_encoder.\n");
}

TEST(PythonDescribe, WithoutNumPyItSaysWhatToInstall) {
  const TemporaryDirectory shadow;
  shadow.write("numpy.py", "raise ModuleNotFoundError(\"No module named 'numpy'\")\n");
  const std::string directory = std::filesystem::path(ENCODER_FILE).parent_path();
  const Outcome outcome = describe("my_rate_encoder", {{"SPIKELOOP_PLUGIN_PATH", directory},
                                                       {"PYTHONPATH", shadow.path().string()}});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err, "spikeloop: plug-in '" ENCODER_FILE
                         "': nodes in Python need NumPy and the package spikeloop: "
                         "ModuleNotFoundError: No module named 'numpy'; install python3-numpy, or "
                         "Spikeloop again [SL0402]\n");
}

TEST(PythonDescribe, WhenPythonDoesNotStartItSaysWhy) {
  const std::string directory = std::filesystem::path(ENCODER_FILE).parent_path();
  const Outcome outcome = describe(
      "my_rate_encoder", {{"SPIKELOOP_PLUGIN_PATH", directory}, {"PYTHONHOME", "/nowhere"}});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr(": Python does not start: "));
  EXPECT_THAT(outcome.err,
              EndsWith("; unset PYTHONHOME and PYTHONPATH, or install python3 again [SL0402]\n"));
}

TEST(PythonDescribe, AVirtualEnvironmentOfTheSamePythonIsUsed) {
  const TemporaryDirectory directory;
  const std::string environment = (directory.path() / "venv").string();
  Command make;
  make.arguments = {"/usr/bin/python3",       "-m",       "venv", "--without-pip",
                    "--system-site-packages", environment};
  ASSERT_EQ(run(make).exit_code, 0);
  directory.write("where.py",
                  "import sys, spikeloop\n"
                  "@spikeloop.node(outputs={'out': 'signal'})\n"
                  "def where(step): ...\n"
                  "raise ValueError(sys.prefix)\n");
  const Outcome outcome = describe("where", {{"SPIKELOOP_PLUGIN_PATH", directory.path().string()},
                                             {"VIRTUAL_ENV", environment}});
  EXPECT_THAT(outcome.err, EndsWith("where.py:4: ValueError: " + environment + " [SL0402]\n"));
}

}  // namespace
}  // namespace spikeloop::test
