// What a user sees of a file or a situation that is wrong: one sentence, soon, and nothing left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>

#include "tests/launch/launcher.hpp"
#include "tests/launch/wrong_files.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;

class WrongFiles : public testing::TestWithParam<Wrong> {};

TEST_P(WrongFiles, AreExplainedInOneSentence) {
  const Wrong& wrong = GetParam();
  const TemporaryDirectory directory;
  write_files(wrong, directory);
  chmod((directory.path() / "script").c_str(), 0755);
  Command command = launcher({"run", "loop.music"});
  command.arguments.insert(command.arguments.end(), wrong.options.begin(), wrong.options.end());
  command.directory = directory.path().string();
  command.environment["ROS_MASTER_URI"] = "http://127.0.0.1:1";
  const auto begin = std::chrono::steady_clock::now();
  const Outcome outcome = run(command);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  std::printf("| %s | %s | %d | %.2f s | %d |\n", wrong.what, last_line(outcome.err).c_str(),
              outcome.exit_code, taken.count(), outcome.left_behind);
  EXPECT_EQ(outcome.exit_code, wrong.exit_code) << outcome.text();
  EXPECT_THAT(last_line(outcome.err), HasSubstr(wrong.words)) << outcome.text();
  EXPECT_EQ(last_line(outcome.err).rfind("spikeloop: ", 0), 0U);
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_LT(taken.count(), 10) << "no deadline governs these, but one for a ROS master (5 s)";
}

// What programs, folders and interpreters that are there, or are not, make of a file.
INSTANTIATE_TEST_SUITE_P(
    Programs, WrongFiles,
    testing::Values(
        Wrong{"np is 2",
              {{"[n]\nnp=1", "[n]\nnp=2"}},
              "spikeloop-network runs in one; write  np=1 [SL0602]"},
        Wrong{"more parts than channels",
              {{"[e]\nnp=1", "[e]\nnp=2"}, {"rate_max=200", "threads=2"}},
              "port 'out' has 3 channels, too few for 4 parts (np times threads); write smaller "
              "ones"},
        Wrong{"binary misspelt",
              {{"rate_encoder", "rate_encodr"}},
              "did you mean 'rate_encoder'? [SL0603]"},
        Wrong{"binary not there",
              {{"rate_encoder", "./brain"}},
              "there is no program './brain', seen"},
        Wrong{"binary not executable",
              {{"rate_encoder", "./brain"}},
              "write  chmod +x ./brain",
              2,
              {{"brain", "#!/bin/sh\n"}}},
        Wrong{"script without interpreter",
              {{"rate_encoder", "./script"}},
              "write a first line like",
              2,
              {{"script", "import nest\n"}}},
        Wrong{"script of Windows",
              {{"rate_encoder", "./script"}},
              "ends as on Windows",
              2,
              {{"script", "#!/usr/bin/python3\r\n"}}},
        Wrong{"interpreter not there",
              {{"rate_encoder", "./script"}},
              "which is not there; install",
              2,
              {{"script", "#!/usr/bin/python7\n"}}},
        Wrong{"script as args",
              {{"rate_encoder", "python3\nargs=brain.py"}},
              "would run the .music file instead"},
        Wrong{"wd not there", {{"rate_max=200", "wd=sub"}}, "there is no directory '"},
        Wrong{"unknown port", {{"e.out ->", "e.spikes ->"}}, "'e' has no output port 'spikes'"},
        Wrong{"unknown port, the only one",
              {{"d.out -> c.in [2]", "d.out -> c.inn [2]"}},
              "loop.music:26:1: 'c' has no input port 'inn'; did you mean 'in'?"},
        Wrong{"width missing", {{"-> e.in [3]", "-> e.in"}}, "has no width; write"},
        Wrong{"widths that a program cannot join",
              {{"d.out -> c.in [2]",
                "d.out -> x.in [2]\n[x]\nnp=1\nbinary=threshold_adapter\nx.out -> c.in [3]"}},
              "loop.music:30:1: port 'x.out' has 3 channels but must have 2, as many as 'x.in'"},
        Wrong{"width beyond all memory",
              {{"s.out -> e.in [3]", "s.out -> e.in [2000000000]"}},
              "loop.music:23:1: the connection of 's.out' has the width 2000000000; write at most "
              "16777216"},
        Wrong{"a label that is not a file name, recorded",
              {{"[e]", "[e/1]"},
               {"e.in", "e/1.in"},
               {"e.out", "e/1.out"},
               {"=200", "=200\nrecord=true"}},
              "loop.music:11:1: the section 'e/1' cannot be recorded"}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

INSTANTIATE_TEST_SUITE_P(
    KeysAndFiles, WrongFiles,
    testing::Values(
        // Tables of grammar and structure are in wrong_texts_test.cpp; one of each here.
        Wrong{"width is a word",
              {{"[3]", "[abc]"}},
              "loop.music:23:16: the width 'abc' is not a whole number"},
        Wrong{"two senders",
              {{"d.out -> c.in", "s.out -> c.in [2]\nd.out -> c.in"}},
              "input 'c.in' has two senders"},
        Wrong{"number is a word", {{"=200", "=fast"}}, "loop.music:10:1: "},
        Wrong{"number out of bounds", {{"=200", "=-3"}}, "loop.music:10:1: "},
        Wrong{"wrong unit", {{"=200", "=200 mV"}}, "loop.music:10:1: "},
        Wrong{"tick of zero", {{"timestep=0.001", "timestep=0"}}, "music_timestep"},
        Wrong{"neither true nor false", {{"rate_max=200", "barrier=yes"}}, "loop.music:10:1: "},
        Wrong{"unknown dialect", {{"rate_max=200", "dialect=rna"}}, "did you mean 'rma'?"},
        Wrong{"unknown key, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max", "rate_mix"}},
              "unknown key 'rate_mix'; did you mean 'rate_max'?"},
        Wrong{"two spellings",
              {{"weights_filename=w.json", "weights_filename=w.json\nweights=w.json"}},
              "are two spellings of one key"},
        Wrong{"weights not there, strict",
              {{"stoptime=0.1", kStrict}, {"=w.json", "=v.json"}},
              "v.json"},
        Wrong{"weights no JSON, strict",
              {{"stoptime=0.1", kStrict}},
              "w.json",
              2,
              {{"w.json", "1 2 3"}}},
        Wrong{"weights empty, strict", {{"stoptime=0.1", kStrict}}, "w.json", 2, {{"w.json", ""}}},
        Wrong{"weights with a short row, strict",
              {{"stoptime=0.1", kStrict}},
              "w.json",
              2,
              {{"w.json", "[[1, 2, 3], [1, 2]]"}}},
        Wrong{"weights of another width, strict",
              {{"stoptime=0.1", kStrict}},
              "the weights have 2 rows and 4 columns",
              2,
              {{"w.json", "[[1, 2, 3, 4], [1, 2, 3, 4]]"}}},
        Wrong{"weights with NaN, strict",
              {{"stoptime=0.1", kStrict}},
              "w.json",
              2,
              {{"w.json", "[[1, 2, NaN], [1, 2, 3]]"}}},
        Wrong{"weights with a word",
              {{"stoptime=0.1", kStrict}},
              "w.json",
              2,
              {{"w.json", "[[1, 2, \"x\"], [1, 2, 3]]"}}},
        Wrong{"network not there", {{"net.yaml", "nat.yaml"}}, "nat.yaml", 4},
        Wrong{"network no YAML", {}, "net.yaml", 2, {{"net.yaml", "populations: {"}}},
        Wrong{"network of another width",
              {{"e.out -> n.in [3]", "e.out -> n.in [3]"}},
              "net.yaml",
              2,
              {{"net.yaml",
                "populations:\n  input: {model: input, size: 4}\n  r: {model: repeater, size: "
                "3}\noutput: [r]\n"}}},
        Wrong{"message type missing",
              {{"zmq_cont_adapter\nmessage_type=FloatArray", "zmq_cont_adapter"}},
              "section 's' has no message_type"},
        Wrong{"message type unknown",
              {{"message_type=FloatArray", "message_type=FlotArray"}},
              "FlotArray"},
        Wrong{"range missing",
              {{"cont_zmq_adapter\nmessage_type=FloatArray",
                "cont_zmq_adapter\nmessage_type=GymCommand"}},
              "carries its range"},
        Wrong{"mapping not there, strict",
              {{"stoptime=0.1", kStrict},
               {"[c]\nnp=1\nbinary=cont_zmq_adapter\nmessage_type=FloatArray\n", kRosCommand}},
              "map.json"},
        Wrong{"mapping of a channel too many",
              {{"[c]\nnp=1\nbinary=cont_zmq_adapter\nmessage_type="
                "FloatArray\n",
                kRosCommand}},
              "map.json",
              2,
              {{"map.json",
                R"({"message_type": "Twist", "mapping": {"linear.x": 7}, "min": -1, "max": 1})"}}},
        Wrong{"mapping of an unknown field",
              {{"[c]\nnp=1\nbinary=cont_zmq_adapter\nmessage_type="
                "FloatArray\n",
                kRosCommand}},
              "linear.w",
              2,
              {{"map.json",
                R"({"message_type": "Twist", "mapping": {"linear.w": 0}, "min": -1, "max": 1})"}}},
        Wrong{"topic missing",
              {{"binary=zmq_cont_adapter\nmessage_type=FloatArray",
                "binary=ros_sensor_adapter\nmessage_type=Laserscan"}},
              "key 'ros_topic' is missing; write for example  ros_topic=/scan"},
        Wrong{"impossible topic",
              {{"binary=zmq_cont_adapter\nmessage_type=FloatArray",
                "binary=ros_sensor_adapter\nmessage_type=Laserscan\nros_topic=my scan"}},
              "my scan"},
        Wrong{"no roscore",
              {{"binary=zmq_cont_adapter\nmessage_type=FloatArray",
                "binary=ros_sensor_adapter\nmessage_type=Laserscan\nros_topic=/scan"}},
              "no ROS master answers at http://127.0.0.1:1",
              3},
        Wrong{"plug-in not there",
              {{"binary=rate_encoder",
                "binary=spikeloop-node\nnode=rate_encoder\n"
                "plugin=./mine.so"}},
              "mine.so"},
        Wrong{"unknown node class",
              {{"binary=rate_encoder", "binary=spikeloop-node\nnode=rate_encodr"}},
              "did you mean 'rate_encoder'? [SL0401]"},
        Wrong{"impossible ZeroMQ address to publish at",
              {{"[c]\nnp=1\nbinary=cont_zmq_adapter",
                "[c]\nnp=1\nbinary=cont_zmq_adapter\nzmq_addr=hello"}},
              "loop.music:22:1: zmq_addr 'hello' is not an address"},
        Wrong{"args for a program of ours, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "args=--rate 5"}},
              "loop.music:11:1: args=--rate 5 is for rate_encoder"},
        Wrong{"wrong option", {}, "--duration", 2, {}, {"--duration", "-1"}},
        Wrong{"duration below the tick",
              {},
              "--duration 1e-05 is less",
              2,
              {},
              {"--duration", "10us"}},
        Wrong{"no hostfile",
              {},
              "open the hostfile 'hosts'",
              4,
              {},
              {"--hostfile", "hosts", "--out", "out"}},
        Wrong{"nonsense for a hostfile",
              {},
              "hosts:1: '[3]' is not a valid host name",
              2,
              {{"hosts", "[3]\n"}},
              {"--hostfile", "hosts", "--out", "out"}},
        Wrong{"arguments for no robot",
              {},
              "--robot-arg requires --robot",
              2,
              {},
              {"--robot-arg=--seed=3"}},
        Wrong{"record without a folder", {}, "--out", 2, {}, {"--record"}}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

}  // namespace
}  // namespace spikeloop::test
