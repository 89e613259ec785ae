// What a user sees of a file or a situation that is wrong: one sentence, soon, and nothing left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>

#include "tests/launch/launcher.hpp"
#include "tests/launch/wrong_files.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

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
  EXPECT_THAT(last_line(outcome.err), Fault(std::string("spikeloop: ... ") + wrong.words))
      << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_LT(taken.count(), 10) << "no deadline governs these, but one for a ROS master (5 s)";
}

// What programs, folders and interpreters that are there, or are not, make of a file.
INSTANTIATE_TEST_SUITE_P(
    Programs, WrongFiles,
    testing::Values(
        Wrong{"np is 2", {{"[n]\nnp=1", "[n]\nnp=2"}}, "12:1: np=2 ... np=1 [SL0602]"},
        Wrong{"more parts than channels",
              {{"[e]\nnp=1", "[e]\nnp=2"}, {"rate_max=200", "threads=2"}},
              "24:1: ... 'out' ... 3 ... 4 ... [SL0602]"},
        Wrong{"binary misspelt",
              {{"rate_encoder", "rate_encodr"}},
              "9:1: ... 'rate_encoder' ... [SL0603]"},
        Wrong{"binary not there", {{"rate_encoder", "./brain"}}, "9:1: ... './brain' ... [SL0603]"},
        Wrong{"binary not executable",
              {{"rate_encoder", "./brain"}},
              "9:1: ... chmod +x ./brain [SL0603]",
              2,
              {{"brain", "#!/bin/sh\n"}}},
        Wrong{"script without interpreter",
              {{"rate_encoder", "./script"}},
              "9:1: ... 'e' ... './script' ... '#!/usr/bin/python3' [SL0603]",
              2,
              {{"script", "import nest\n"}}},
        Wrong{"script of Windows",
              {{"rate_encoder", "./script"}},
              "9:1: ... 'e' ... './script' ... Windows ... [SL0603]",
              2,
              {{"script", "#!/usr/bin/python3\r\n"}}},
        Wrong{"interpreter not there",
              {{"rate_encoder", "./script"}},
              "9:1: ... 'e' ... './script' ... '/usr/bin/python7' ... [SL0603]",
              2,
              {{"script", "#!/usr/bin/python7\n"}}},
        Wrong{"script as args",
              {{"rate_encoder", "python3\nargs=brain.py"}},
              "9:1: ... 'e' ... 'brain.py' ... [SL0603]"},
        Wrong{"wd not there", {{"rate_max=200", "wd=sub"}}, "10:1: ... /sub' ... [SL0603]"},
        Wrong{"unknown port",
              {{"e.out ->", "e.spikes ->"}},
              "24:1: ... 'e' ... 'spikes' ... [SL0302]"},
        Wrong{"unknown port, the only one",
              {{"d.out -> c.in [2]", "d.out -> c.inn [2]"}},
              "26:1: ... 'c' ... 'inn' ... 'in' ... [SL0302]"},
        Wrong{"width missing", {{"-> e.in [3]", "-> e.in"}}, "23:1: ... 's.out' ... [SL0307]"},
        Wrong{"widths that a program cannot join",
              {{"d.out -> c.in [2]",
                "d.out -> x.in [2]\n[x]\nnp=1\nbinary=threshold_adapter\nx.out -> c.in [3]"}},
              "30:1: ... 'x.out' ... 3 ... 2 ... 'x.in' ... [SL0306]"},
        Wrong{"width beyond all memory",
              {{"s.out -> e.in [3]", "s.out -> e.in [2000000000]"}},
              "23:1: ... 's.out' ... 2000000000 ... 16777216 ... [SL0307]"},
        Wrong{"a label that is not a file name, recorded",
              {{"[e]", "[e/1]"},
               {"e.in", "e/1.in"},
               {"e.out", "e/1.out"},
               {"=200", "=200\nrecord=true"}},
              "11:1: ... 'e/1' ... [SL0602]"}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

INSTANTIATE_TEST_SUITE_P(
    KeysAndFiles, WrongFiles,
    testing::Values(
        // Tables of grammar and structure are in wrong_texts_test.cpp; one of each here.
        Wrong{"width is a word", {{"[3]", "[abc]"}}, "23:16: ... 'abc' ... [SL0307]"},
        Wrong{"two senders",
              {{"d.out -> c.in", "s.out -> c.in [2]\nd.out -> c.in"}},
              "27:1: ... 'c.in' ... [SL0304]"},
        Wrong{"number is a word", {{"=200", "=fast"}}, "10:1: ... 'fast' ... [SL0201]"},
        Wrong{"number out of bounds", {{"=200", "=-3"}}, "10:1: ... -3 ... [SL0203]"},
        Wrong{"wrong unit", {{"=200", "=200 mV"}}, "10:1: ... '200 mV' ... [SL0202]"},
        Wrong{"tick of zero",
              {{"timestep=0.001", "timestep=0"}},
              "2:1: ... 'music_timestep': 0 ... [SL0203]"},
        Wrong{"neither true nor false",
              {{"rate_max=200", "barrier=yes"}},
              "10:1: ... 'yes' ... [SL0205]"},
        Wrong{"unknown dialect", {{"rate_max=200", "dialect=rna"}}, "10:1: ... 'rma' ... [SL0205]"},
        Wrong{"unknown key, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max", "rate_mix"}},
              "11:1: ... 'rate_mix' ... 'rate_max' ... [SL0103]"},
        Wrong{"two spellings",
              {{"weights_filename=w.json", "weights_filename=w.json\nweights=w.json"}},
              "18:1: ... 'weights' ... 'weights_filename' ... [SL0102]"},
        Wrong{"weights not there, strict",
              {{"stoptime=0.1", kStrict}, {"=w.json", "=v.json"}},
              "19:1: ... v.json ... [SL0108]"},
        Wrong{"weights no JSON, strict",
              {{"stoptime=0.1", kStrict}},
              "19:1: ... w.json ... [SL0101]",
              2,
              {{"w.json", "1 2 3"}}},
        Wrong{"weights empty, strict",
              {{"stoptime=0.1", kStrict}},
              "19:1: ... w.json ... [SL0309]",
              2,
              {{"w.json", ""}}},
        Wrong{"weights with a short row, strict",
              {{"stoptime=0.1", kStrict}},
              "19:1: ... w.json ... [SL0309]",
              2,
              {{"w.json", "[[1, 2, 3], [1, 2]]"}}},
        Wrong{"weights of another width, strict",
              {{"stoptime=0.1", kStrict}},
              "19:1: ... 2 rows and 4 columns ... [SL0308]",
              2,
              {{"w.json", "[[1, 2, 3, 4], [1, 2, 3, 4]]"}}},
        Wrong{"weights with NaN, strict",
              {{"stoptime=0.1", kStrict}},
              "19:1: ... w.json ... [SL0101]",
              2,
              {{"w.json", "[[1, 2, NaN], [1, 2, 3]]"}}},
        Wrong{"weights with a word",
              {{"stoptime=0.1", kStrict}},
              "19:1: ... w.json ... [SL0309]",
              2,
              {{"w.json", "[[1, 2, \"x\"], [1, 2, 3]]"}}},
        Wrong{
            "network not there", {{"net.yaml", "nat.yaml"}}, "14:1: ... nat.yaml ... [SL0109]", 4},
        Wrong{"network no YAML",
              {},
              "net.yaml:1:1: ... [SL0101]",
              2,
              {{"net.yaml", "populations: {"}}},
        Wrong{"network of another width",
              {{"e.out -> n.in [3]", "e.out -> n.in [3]"}},
              "24:1: ... net.yaml ... [SL0306]",
              2,
              {{"net.yaml",
                "populations:\n  input: {model: input, size: 4}\n  r: {model: repeater, size: "
                "3}\noutput: [r]\n"}}},
        Wrong{"message type missing",
              {{"zmq_cont_adapter\nmessage_type=FloatArray", "zmq_cont_adapter"}},
              "3:1: ... 's' ... message_type ... [SL0104]"},
        Wrong{"message type unknown",
              {{"message_type=FloatArray", "message_type=FlotArray"}},
              "6:1: ... 'FlotArray' ... [SL0502]"},
        Wrong{"range missing",
              {{"cont_zmq_adapter\nmessage_type=FloatArray",
                "cont_zmq_adapter\nmessage_type=GymCommand"}},
              "19:1: ... min=-1 and max=1 [SL0206]"},
        Wrong{"mapping not there, strict",
              {{"stoptime=0.1", kStrict},
               {"[c]\nnp=1\nbinary=cont_zmq_adapter\nmessage_type=FloatArray\n", kRosCommand}},
              "24:1: ... map.json ... [SL0108]"},
        Wrong{"mapping of a channel too many",
              {{"[c]\nnp=1\nbinary=cont_zmq_adapter\nmessage_type="
                "FloatArray\n",
                kRosCommand}},
              "map.json:1:39: ... 7 ... 2 ... [SL0505]",
              2,
              {{"map.json",
                R"({"message_type": "Twist", "mapping": {"linear.x": 7}, "min": -1, "max": 1})"}}},
        Wrong{"mapping of an unknown field",
              {{"[c]\nnp=1\nbinary=cont_zmq_adapter\nmessage_type="
                "FloatArray\n",
                kRosCommand}},
              "map.json:1:39: ... linear.w ... [SL0504]",
              2,
              {{"map.json",
                R"({"message_type": "Twist", "mapping": {"linear.w": 0}, "min": -1, "max": 1})"}}},
        Wrong{"topic missing",
              {{"binary=zmq_cont_adapter\nmessage_type=FloatArray",
                "binary=ros_sensor_adapter\nmessage_type=Laserscan"}},
              "3:1: ... ros_topic=/scan [SL0104]"},
        Wrong{"impossible topic",
              {{"binary=zmq_cont_adapter\nmessage_type=FloatArray",
                "binary=ros_sensor_adapter\nmessage_type=Laserscan\nros_topic=my scan"}},
              "7:1: ... 'my scan' ... [SL0501]"},
        Wrong{"no roscore",
              {{"binary=zmq_cont_adapter\nmessage_type=FloatArray",
                "binary=ros_sensor_adapter\nmessage_type=Laserscan\nros_topic=/scan"}},
              "http://127.0.0.1:1; ... --roscore [SL0701]",
              3},
        Wrong{"plug-in not there",
              {{"binary=rate_encoder",
                "binary=spikeloop-node\nnode=rate_encoder\n"
                "plugin=./mine.so"}},
              "11:1: ... mine.so ... [SL0402]"},
        Wrong{"unknown node class",
              {{"binary=rate_encoder", "binary=spikeloop-node\nnode=rate_encodr"}},
              "10:1: ... 'rate_encoder' ... [SL0401]"},
        Wrong{"impossible ZeroMQ address to publish at",
              {{"[c]\nnp=1\nbinary=cont_zmq_adapter",
                "[c]\nnp=1\nbinary=cont_zmq_adapter\nzmq_addr=hello"}},
              "22:1: zmq_addr 'hello' ... [SL0501]"},
        Wrong{"args for a program of ours, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "args=--rate 5"}},
              "11:1: args=--rate 5 ... rate_encoder ... [SL0602]"},
        Wrong{"wrong option", {}, "--duration -1: ...", 2, {}, {"--duration", "-1"}},
        Wrong{"duration below the tick",
              {},
              "--duration 1e-05 ... 1 ms ... [SL0203]",
              2,
              {},
              {"--duration", "10us"}},
        Wrong{"no hostfile",
              {},
              "'hosts' ... [SL0109]",
              4,
              {},
              {"--hostfile", "hosts", "--out", "out"}},
        Wrong{"nonsense for a hostfile",
              {},
              "hosts:1: '[3]' ... [SL0106]",
              2,
              {{"hosts", "[3]\n"}},
              {"--hostfile", "hosts", "--out", "out"}},
        Wrong{"arguments for no robot",
              {},
              "--robot-arg requires --robot; ...",
              2,
              {},
              {"--robot-arg=--seed=3"}},
        Wrong{"record without a folder", {}, "--out; ...", 2, {}, {"--record"}}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

}  // namespace
}  // namespace spikeloop::test
