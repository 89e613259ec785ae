// What a user sees of a file or a situation that is wrong: one sentence, soon, and nothing left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <map>

#include "tests/launch/launcher.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;

constexpr const char* kGood = R"(stoptime=0.1
music_timestep=0.001
[s]
np=1
binary=zmq_cont_adapter
message_type=FloatArray
[e]
np=1
binary=rate_encoder
rate_max=200
[n]
np=1
binary=spikeloop-network
network=net.yaml
[d]
np=1
binary=linear_readout_decoder
weights_filename=w.json
[c]
np=1
binary=cont_zmq_adapter
message_type=FloatArray
s.out -> e.in [3]
e.out -> n.in [3]
n.out -> d.in [3]
d.out -> c.in [2]
)";
constexpr const char* kNetwork =
    "populations:\n  input: {model: input, size: 3}\n  r: {model: repeater, size: 3}\n"
    "connections:\n  - {from: input, to: r, rule: one_to_one, delay: 1 ms}\noutput: [r]\n";
constexpr const char* kWeights = "[[1, 0, 0], [0, 1, 0]]";

const std::string kRosCommand =
    "[c]\nnp=1\nbinary=ros_command_adapter\nros_topic=/"
    "cmd_vel\nmessage_mapping_filename=map.json\n";

struct Wrong {
  const char* what;
  /// What to write instead of a part of the good file; an empty part: the whole file.
  std::vector<std::pair<std::string, std::string>> instead;
  const char* words;  ///< in the last line
  int exit_code = 2;
  std::map<std::string, std::string> files{};  ///< more of them, or others
  std::vector<std::string> options{};
};

void PrintTo(const Wrong& wrong, std::ostream* out) {
  *out << wrong.what;
}

std::string text_of(const Wrong& wrong) {
  std::string text = kGood;
  for (const auto& [part, other] : wrong.instead) {
    const auto place = part.empty() ? 0 : text.find(part);
    EXPECT_NE(place, std::string::npos) << part;
    text.replace(place, part.empty() ? text.size() : part.size(), other);
  }
  return text;
}

class WrongFiles : public testing::TestWithParam<Wrong> {};

TEST_P(WrongFiles, AreExplainedInOneSentence) {
  const Wrong& wrong = GetParam();
  const TemporaryDirectory directory;
  auto files = wrong.files;
  files.insert({{"net.yaml", kNetwork}, {"w.json", kWeights}, {"loop.music", text_of(wrong)}});
  for (const auto& [name, text] : files) {
    directory.write(name, text);
  }
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

const std::string kStrict = "strict=true\nstoptime=0.1";

INSTANTIATE_TEST_SUITE_P(
    Grammar, WrongFiles,
    testing::Values(
        Wrong{"width is a word",
              {{"[3]", "[abc]"}},
              "loop.music:23:16: the width 'abc' is no whole number"},
        Wrong{"width is negative", {{"[3]", "[-3]"}}, "the width '-3' is no whole number"},
        Wrong{"width without bracket", {{"[3]", "[3"}}, "the width '[3' has no ']'; write '[3]'"},
        Wrong{"two numbers", {{"[3]", "[3 4]"}}, "two numbers in a width"},
        Wrong{"a fourth option", {{"[3]", "[3, point-to-point, tree, x]"}}, "a fourth option"},
        Wrong{"width too large", {{"[3]", "[99999999999]"}}, "the width 99999999999 is too large"},
        Wrong{"width of zero", {{"[3]", "[0]"}}, "has width 0; write at least 1"},
        Wrong{"unknown communication", {{"[3]", "[3, foo]"}}, "unknown communication 'foo'"},
        Wrong{"unknown processing", {{"[3]", "[3, collective, foo]"}}, "unknown processing 'foo'"},
        Wrong{"label without bracket", {{"[e]", "[e"}}, "the section '[e' has no ']'; write '[e]'"},
        Wrong{"text behind a label", {{"[e]", "[e] x"}}, "text after the section '[e]'"},
        Wrong{"quote never closed", {{"=FloatArray", "=\"Float"}}, "is never closed"},
        Wrong{"line without =", {{"rate_max=200", "rate_max 200"}}, "loop.music:10:1"},
        Wrong{"key without name", {{"rate_max=200", "=200"}}, "no key before '='"},
        Wrong{"double arrow", {{"s.out -> e.in", "s.out => e.in"}}, "write a connection with '->'"},
        Wrong{"two arrows", {{"s.out -> e.in", "s.out -> e.in -> n.in"}}, "a second arrow"},
        Wrong{"no receiver", {{"s.out -> e.in [3]", "s.out -> [3]"}}, "has no receiver port"},
        Wrong{"connection at the top",
              {{"stoptime", "out -> e.in\nstoptime"}},
              "application of port"},
        Wrong{"empty file", {{"", ""}}, "the file has no application"},
        Wrong{"only comments", {{"", "# nothing\n"}}, "the file has no application"},
        Wrong{"byte order mark", {{"stoptime", "\xEF\xBB\xBFstoptime"}}, "byte order mark"},
        Wrong{"UTF-16", {{"", std::string("\xFF\xFE[\0", 4)}}, "the file is UTF-16 text"},
        Wrong{"binary file",
              {{"", std::string("\x7f"
                                "ELF\0\0",
                                6)}},
              "this is no text file"},
        Wrong{"huge file",
              {{"stoptime", "#" + std::string(5'000'000, 'x') + "\nstoptime"}},
              "more than the 4 MB that a .music file may have"},
        Wrong{"huge key",
              {{"rate_max=200", "note=" + std::string(140'000, 'x')}},
              "in one environment string"},
        Wrong{"key twice, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "rate_max=2\nrate_max=3"}},
              "the key 'rate_max' is '2' in line 11 already"}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

INSTANTIATE_TEST_SUITE_P(
    Structure, WrongFiles,
    testing::Values(
        Wrong{
            "unknown application", {{"-> e.in", "-> encoder.in"}}, "unknown application 'encoder'"},
        Wrong{"connected to itself", {{"-> e.in", "-> s.in"}}, "joins an application to itself"},
        Wrong{"port in and out",
              {{"e.out -> n.in", "e.in -> n.in"}},
              "is both an output and an input"},
        Wrong{"np missing", {{"[e]\nnp=1", "[e]"}}, "the section '[e]' has no np"},
        Wrong{"np is a word", {{"[e]\nnp=1", "[e]\nnp=one"}}, "np of '[e]' is 'one'"},
        Wrong{"np is 0", {{"[e]\nnp=1", "[e]\nnp=0"}}, "np of '[e]' is '0'"},
        Wrong{
            "np is 2", {{"[n]\nnp=1", "[n]\nnp=2"}}, "spikeloop-network runs in one; write  np=1"},
        Wrong{"more parts than channels",
              {{"[e]\nnp=1", "[e]\nnp=2"}, {"rate_max=200", "threads=2"}},
              "port 'out' has 3 channels, too few for 4 parts (np times threads); write smaller "
              "ones"},
        Wrong{"binary missing", {{"binary=rate_encoder\n", ""}}, "the section '[e]' has no binary"},
        Wrong{"binary empty", {{"binary=rate_encoder", "binary="}}, "binary of '[e]' is empty"},
        Wrong{"binary misspelt", {{"rate_encoder", "rate_encodr"}}, "did you mean 'rate_encoder'?"},
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
        Wrong{"connection repeated",
              {{"s.out -> e.in [3]", "s.out -> e.in [3]\ns.out -> e.in [3]"}},
              "stands in line 23 already, and MUSIC would hang"},
        Wrong{"two senders",
              {{"d.out -> c.in", "s.out -> c.in [2]\nd.out -> c.in"}},
              "the input 'c.in' has two senders"},
        Wrong{"no connection",
              {{"d.out -> c.in [2]\n", ""}},
              "has no connection, and MUSIC would hang"},
        Wrong{"unknown port", {{"e.out ->", "e.spikes ->"}}, "'e' has no port 'spikes'"},
        Wrong{"unknown port, the only one",
              {{"d.out -> c.in [2]", "d.out -> c.inn [2]"}},
              "c: loop.music:26:1: 'c' has no port 'inn'; did you mean 'in'?"},
        Wrong{"width missing", {{"-> e.in [3]", "-> e.in"}}, "has no width; write"},
        Wrong{"spikes into a signal",
              {{"n.out -> d.in [3]\nd.out -> c.in [2]", "n.out -> c.in [3]\ne.out -> d.in [3]\n"}},
              "sends spikes, but 'c' takes a continuous signal"},
        Wrong{"signal into spikes",
              {{"s.out -> e.in [3]\ne.out -> n.in [3]", "s.out -> n.in [3]\ns.out -> e.in [3]"}},
              "sends a continuous signal, but 'n' takes spikes"},
        Wrong{"two widths of an output",
              {{"n.out -> d.in [3]",
                "n.out -> d.in [3]\nn.out -> x.in [4]\n[x]\n"
                "np=1\nbinary=spikeloop-network\n"
                "network=net.yaml"}},
              "has another width in line"},
        Wrong{
            "unequal ticks", {{"rate_max=200", "music_timestep=0.01"}}, "but that of 's' is 1 ms"},
        Wrong{"widths that a program cannot join",
              {{"d.out -> c.in [2]",
                "d.out -> x.in [2]\n[x]\nnp=1\nbinary=threshold_adapter\nx.out -> c.in [3]"}},
              "x: loop.music:30:1: 'x': port 'in' has 2 channels and port 'out' 3"},
        Wrong{"width beyond all memory",
              {{"s.out -> e.in [3]", "s.out -> e.in [2000000000]"}},
              "loop.music:23:1: the connection of 's.out' has the width 2000000000; write at most "
              "16777216"},
        Wrong{"two publishers at one address",
              {{"d.out -> c.in [2]",
                "d.out -> c.in [2]\nd.out -> x.in [2]\n[x]\nnp=1\nbinary=cont_zmq_adapter\n"
                "message_type=FloatArray\n"}},
              "'c' and 'x' both publish at tcp://127.0.0.1:5556"},
        Wrong{"a label that is no file name, recorded",
              {{"[e]", "[e/1]"},
               {"e.in", "e/1.in"},
               {"e.out", "e/1.out"},
               {"=200", "=200\nrecord=true"}},
              "e/1: loop.music:11:1: the section 'e/1' cannot be recorded"},
        Wrong{"shorter than a tick",
              {{"stoptime=0.1", "stoptime=0.0001"}},
              "less than its tick of 1 ms"},
        Wrong{"unequal lengths, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "stoptime=5"}},
              "'e' runs for 5 s, but 's' for 100 ms"},
        Wrong{"barriers that differ", {{"rate_max=200", "barrier=false"}}, "the job would hang"},
        Wrong{"loop of signals",
              {{"d.out -> c.in [2]",
                "d.out -> c.in [2]\n[x]\nnp=1\n"
                "binary=threshold_adapter\n[y]\nnp=1\nbinary="
                "threshold_adapter\nx.out -> y.in [1]\n"
                "y.out -> x.in [1]"}},
              "the cycle x -> y -> x lacks 2 ms of acceptable latency"}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

INSTANTIATE_TEST_SUITE_P(
    KeysAndFiles, WrongFiles,
    testing::Values(
        Wrong{"number is a word", {{"=200", "=fast"}}, "e: loop.music:10:1: "},
        Wrong{"number out of bounds", {{"=200", "=-3"}}, "e: loop.music:10:1: "},
        Wrong{"wrong unit", {{"=200", "=200 mV"}}, "e: loop.music:10:1: "},
        Wrong{"tick of zero", {{"timestep=0.001", "timestep=0"}}, "music_timestep"},
        Wrong{"neither true nor false", {{"rate_max=200", "barrier=yes"}}, "e: loop.music:10:1: "},
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
              "section 's' has no ros_topic"},
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
              "did you mean 'rate_encoder'?"},
        Wrong{"impossible ZeroMQ address to publish at",
              {{"[c]\nnp=1\nbinary=cont_zmq_adapter",
                "[c]\nnp=1\nbinary=cont_zmq_adapter\nzmq_addr=hello"}},
              "c: loop.music:22:1: zmq_addr 'hello' is no address"},
        Wrong{"args for a program of ours, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "args=--rate 5"}},
              "e: loop.music:11:1: args=--rate 5 is for rate_encoder"},
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
              "hosts:1: '[3]' is no name of a host",
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
