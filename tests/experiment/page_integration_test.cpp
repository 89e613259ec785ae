// docs/experiment-file.md says what the program says, and `spikeloop describe` knows what
// experiment files know.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "tests/experiment/program.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string document(const std::string& name) {
  std::ifstream file(std::string(SPIKELOOP_DOCS) + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const auto from = text.find(begin);
  const auto to = text.find(end, from == std::string::npos ? 0 : from + begin.size());
  if (from == std::string::npos || to == std::string::npos) {
    ADD_FAILURE() << "nothing between " << begin << " and " << end;
    return "";
  }
  return text.substr(from + begin.size(), to - from - begin.size());
}

std::string replaced(std::string text, const std::string& node, const std::string& by) {
  const auto at = text.find(node);
  EXPECT_NE(at, std::string::npos) << node;
  return at == std::string::npos ? text : text.replace(at, node.size(), by);
}

TEST(ExperimentPage, HasTheKeysOfToday) {
  const TemporaryDirectory directory;
  const std::string page = document("experiment-file.md");
  const std::string keys = spikeloop({"describe", "--experiment", "--markdown"}, directory).out;
  EXPECT_EQ(between(page, "a test compares -->\n", "\n<!-- end -->"), keys)
      << "docs/experiment-file.md is old; put what  spikeloop describe --experiment --markdown\n"
         "prints between its comments";
}

class Example : public testing::Test {
 protected:
  Example() {
    std::string row = "[0";
    for (int i = 0; i < 99; ++i) {
      row += ",0";
    }
    directory_.write("readout.json", "[" + row + "], " + row + "]]");
    directory_.write(
        "brain.yaml",
        "populations:\n  i: {model: input, size: 100}\n  r: {model: repeater, size: 100}\n"
        "connections:\n  - {from: i, to: r, rule: one_to_one, delay: 1 ms}\n"
        "output: [r]\n");
  }

  TemporaryDirectory directory_;
  std::string page_ = document("experiment-file.md");
  std::string example_ = between(page_, "```yaml\n", "```\n");
};

TEST_F(Example, IsRight) {
  directory_.write("small.yaml", example_);
  EXPECT_EQ(spikeloop({"check", "small.yaml"}, directory_).text(),
            "small.yaml: OK: 5 nodes, 4 connections, tick 1 ms, 60 s\n");
}

TEST_F(Example, IsCheckedAsThePageSays) {
  std::string wrong = replaced(example_, "200 Hz", "200");
  wrong = replaced(wrong, "tau: 30 ms", "tua: 30 ms");
  directory_.write("small.yaml", replaced(wrong, "brain [100] -> d", "brian [100] -> d"));
  std::string said;
  std::string line;
  for (const char c : between(page_, "$ spikeloop check small.yaml\n", "\n\n") + "\n") {
    line += c;
    if (c == '\n') {
      said += line.substr(std::min<std::size_t>(4, line.size()));
      line.clear();
    }
  }
  EXPECT_EQ(spikeloop({"check", "small.yaml"}, directory_).err, said);
}

/// Where they stand depends on the fonts of the machine.
std::vector<std::string> texts_in(const std::string& svg) {
  static const std::regex kText(">([^<]*)</text>");
  std::vector<std::string> texts;
  for (std::sregex_iterator at(svg.begin(), svg.end(), kText), end; at != end; ++at) {
    texts.push_back((*at)[1]);
  }
  return texts;
}

TEST(ExperimentPage, HasThePictureOfToday) {
  const TemporaryDirectory directory;
  directory.write("explorer.yaml", spikeloop({"new"}, directory).out);
  EXPECT_EQ(texts_in(spikeloop({"graph", "explorer.yaml"}, directory).out),
            texts_in(document("images/explorer.svg")))
      << "docs/images/explorer.svg is old; renew it with  spikeloop new > explorer.yaml &&\n"
         "spikeloop graph explorer.yaml --out docs/images/explorer.svg";
}

TEST(DescribeExperiment, KnowsTopicsRecordingsAndTheNetwork) {
  const TemporaryDirectory directory;
  const Outcome sensor = spikeloop({"describe", "ros_sensor"}, directory);
  EXPECT_EQ(sensor.exit_code, 0) << sensor.err;
  EXPECT_THAT(
      sensor.out,
      StartsWith("ros_sensor: Converts the newest message of a topic to a continuous signal\n"
                 "Source: Weidel et al. 2016, section 2.2\n\nPorts:\n  out  output  "
                 "continuous  any width  Numbers of the message\n\nParameters:\n  topic "));
  EXPECT_THAT(sensor.out, testing::EndsWith("\nWrite  node: ros_sensor  in an experiment file.\n"));
  for (const char* name :
       {"ros_command", "spike_playback", "signal_playback", "network", "simulator"}) {
    EXPECT_THAT(spikeloop({"describe", name}, directory).out, StartsWith(name + std::string(": ")));
  }
  EXPECT_THAT(spikeloop({"describe", "network"}, directory).out,
              HasSubstr("Write  simulator: builtin  in an experiment file. "));
  EXPECT_THAT(spikeloop({"describe"}, directory).out,
              HasSubstr("Only in experiment files: topics, recordings, the network, simulators\n"
                        "  network  "));
  EXPECT_EQ(spikeloop({"describe", "ros_senser"}, directory).err,
            "spikeloop: unknown node class 'ros_senser'; did you mean 'ros_sensor'?\n");
}

TEST(DescribeMessage, ShowsWhatBothRosHave) {
  const TemporaryDirectory directory;
  const Outcome outcome = spikeloop({"describe", "std_msgs/msg/Header"}, directory);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "std_msgs/Header\n"
            "  ROS 1: md5 2176decaecbce78abc3b96ef049fabed\n"
            "  ROS 2: RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01\n"
            "\nDefinition of ROS 1:\n  uint32 seq\n  time stamp\n  string frame_id\n"
            "\nDefinition of ROS 2:\n  builtin_interfaces/Time stamp\n  string frame_id\n"
            "\nField paths of ROS 1:\n  seq       uint32\n  stamp     seconds\n"
            "  frame_id  string\n"
            "\nField paths of ROS 2:\n  stamp     seconds\n  frame_id  string\n"
            "Of an array: ranges[7], ranges[0:100], position[name=left_wheel]. Of a time: .sec, "
            ".nanosec.\n");
  EXPECT_THAT(spikeloop({"describe", "std_msgs/Float32MultiArray"}, directory).out,
              HasSubstr("\nField paths:\n  layout.dim[0].label   string\n"
                        "  layout.dim[0].size    uint32\n  layout.dim[0].stride  uint32\n"
                        "  layout.data_offset    uint32\n  data                  float32[]\n"));
  EXPECT_THAT(spikeloop({"describe", "geometry_msgs/VelocityStamped"}, directory).out,
              HasSubstr("\n  ROS 1: none\n"));
  EXPECT_EQ(spikeloop({"describe", "std_msgs/Headr"}, directory).err,
            "spikeloop: unknown message type 'std_msgs/Headr'; did you mean 'std_msgs/Header'? "
            "[SL0502]\n");
}

TEST(DescribeMessage, ReadsAFileOfOnesOwn) {
  const TemporaryDirectory directory;
  std::filesystem::create_directories(directory.path() / "my_robot/msg");
  directory.write("my_robot/msg/Arm.msg", "string<=8 name\nfloat64[<=3] angles\n");
  EXPECT_THAT(spikeloop({"describe", "my_robot/msg/Arm.msg"}, directory).out,
              HasSubstr("my_robot/Arm\n  ROS 1: none\n  ROS 2: RIHS01_"));
  EXPECT_THAT(
      spikeloop({"describe", "my_robot/msg/Leg.msg"}, directory).err,
      Fault("spikeloop: message definition 'my_robot/msg/Leg.msg' ... .msg file ... [SL0502]\n"));
}

TEST(DescribeMessage, ListsThemAll) {
  const TemporaryDirectory directory;
  const std::string list = spikeloop({"describe", "--messages"}, directory).out;
  EXPECT_THAT(list, StartsWith("builtin_interfaces/Duration  (ROS 2)\n"));
  EXPECT_THAT(list, HasSubstr("\nsensor_msgs/Image\n"));
  EXPECT_THAT(list, HasSubstr("\nrosgraph_msgs/Log  (ROS 1)\n"));
}

TEST(DescribeExperiment, ShowsTheFilesKeys) {
  const TemporaryDirectory directory;
  const Outcome outcome = spikeloop({"describe", "--experiment"}, directory);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\n  tick "));
  EXPECT_THAT(outcome.out, HasSubstr("\nrobot: Robot that is simulated in this process, or what "
                                     "replaces it: write  simulator, environment  or  bag.\n"));
  EXPECT_EQ(spikeloop({"describe", "connect", "--experiment"}, directory).exit_code, 2);
}

}  // namespace
}  // namespace spikeloop::test
