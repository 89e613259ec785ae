// What is read from files that are right: units, defaults, widths, delays, ways to write.
#include <gmock/gmock.h>

#include <algorithm>

#include "spikeloop/record/recorder.hpp"
#include "tests/experiment/experiment_text.hpp"

namespace spikeloop::test {
namespace {

using experiment::Connection;
using experiment::Experiment;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

class GoodFiles : public testing::Test {
 protected:
  Experiment good(const std::string& text, const experiment::Overrides& overrides = {}) {
    files_.emplace_back(std::make_unique<Files>(text, more_));
    Read result = read(*files_.back(), types_, overrides);
    EXPECT_THAT(result.faults, IsEmpty()) << text;
    return std::move(result.experiment);
  }

  experiment::NodeTypes types_;
  std::map<std::string, std::string> more_;
  std::vector<std::unique_ptr<Files>> files_;
};

std::vector<std::string> texts(const Experiment& experiment) {
  std::vector<std::string> result;
  for (const Connection& connection : experiment.connections) {
    result.push_back(
        connection.from + " -> " + connection.to + " [" + std::to_string(connection.width) +
        (connection.delay_ticks ? ", " + std::to_string(*connection.delay_ticks) : "") + "]");
  }
  return result;
}

TEST_F(GoodFiles, Defaults) {
  const Experiment experiment =
      good(with({{"experiment: table\nduration: 1 s\ntick: 1 ms\n", ""}}));
  EXPECT_EQ(experiment.name, "x");
  EXPECT_FALSE(experiment.duration);
  EXPECT_EQ(experiment.tick, 1'000'000);
  EXPECT_EQ(experiment.seed, 1U);
  EXPECT_EQ(experiment.sync, experiment::Sync::realtime);
  EXPECT_EQ(experiment.real_time_factor, 1);
  EXPECT_EQ(experiment.ros, experiment::Ros::none);
  ASSERT_TRUE(experiment.robot);
  EXPECT_EQ(experiment.robot->world, "arena.xml");
  EXPECT_EQ(experiment.robot->seed, 1U);
  EXPECT_EQ(experiment.node("encoder").parameters.number("rate_min"), 0);
  EXPECT_FALSE(experiment.node("encoder").parameters.given("rate_min"));
}

TEST_F(GoodFiles, KeysAndUnits) {
  const Experiment experiment = good(with({{"1 s", "2 min"},
                                           {"tick: 1 ms", "tick: 500 us\nseed: 7\nsync: lockstep"},
                                           {"200 Hz", "0.2 kHz, rate_min: 0"},
                                           {"30 ms", "0.03 s"}}));
  EXPECT_EQ(experiment.name, "table");
  EXPECT_EQ(experiment.duration, 120'000'000'000);
  EXPECT_EQ(experiment.tick, 500'000);
  EXPECT_EQ(experiment.seed, 7U);
  EXPECT_EQ(experiment.robot->seed, 7U);
  EXPECT_EQ(experiment.sync, experiment::Sync::lockstep);
  EXPECT_DOUBLE_EQ(experiment.node("encoder").parameters.number("rate_max"), 200);
  EXPECT_TRUE(experiment.node("encoder").parameters.given("rate_min"));
  EXPECT_DOUBLE_EQ(experiment.node("decoder").parameters.number("tau"), 0.03);
  EXPECT_EQ(experiment.node("scan").parameters.text("message"), "sensor_msgs/LaserScan");
}

TEST_F(GoodFiles, MessagesHaveNamesOrFiles) {
  more_ = {{"my_robot/msg/Arm.msg", "string[] name\nfloat64[] angle\nGrip grip\n"},
           {"my_robot/msg/Grip.msg", "float32 force\n"}};
  const Experiment own = good(with(
      {{"robot: {simulator: mujoco}", "ros: 1"},
       {"message: LaserScan",
        "message: my_robot/msg/Arm.msg, fields: [\"angle[0:2]\", grip.force]"},
       {"message: Twist, fields: {linear.x: 0, angular.z: 1}",
        "message: ./my_robot/msg/Arm.msg, fields: {\"angle[name=left]\": 0, grip.force: 1}"}}));
  EXPECT_TRUE(own.node("scan").parameters.text("message").ends_with("/my_robot/msg/Arm.msg"));
  EXPECT_TRUE(own.node("wheels").mapping.message_type.ends_with("/my_robot/msg/Arm.msg"));
  const Experiment known =
      good(with({{"robot: {simulator: mujoco}", "ros: 1"},
                 {"message: LaserScan", "message: JointState, fields: [\"position[0:3]\"]"},
                 {"message: Twist, fields: {linear.x: 0, angular.z: 1}",
                  "message: sensor_msgs/msg/JointState, fields: {\"velocity[name=left]\": 0}"}}));
  EXPECT_EQ(known.node("scan").parameters.text("message"), "sensor_msgs/JointState");
  EXPECT_EQ(known.node("wheels").mapping.message_type, "sensor_msgs/JointState");
}

TEST_F(GoodFiles, MessagesAreThoseOfItsRos) {
  const auto stopped_by = [&](const std::string& ros, const std::string& field) {
    Files files(with({{"robot: {simulator: mujoco}", "ros: " + ros},
                      {"angular.z: 1}",
                       "angular.z: 1}, emergency_stop: {message: std_msgs/Header, "
                       "field: " +
                           field + "}"}}),
                {});
    return read(files, types_, {}).faults;
  };
  EXPECT_THAT(stopped_by("1", "seq"), IsEmpty());
  EXPECT_THAT(stopped_by("2", "stamp.nanosec"), IsEmpty());
  EXPECT_THAT(stopped_by("2", "seq"), SizeIs(1));  // ROS 2 has no such field
}

TEST_F(GoodFiles, RobotHasItsOwnSeed) {
  EXPECT_EQ(good(with({{"mujoco}", "mujoco, seed: 3}"}})).robot->seed, 3U);
}

TEST_F(GoodFiles, AReadoutAtTheEndIsAsWideAsItsWeights) {
  const Experiment experiment =
      good(with({{"  wheels: {", "  end: {node: linear_readout, weights: w.json}\n  wheels: {"},
                 {"wheels [2]\n", "wheels [2]\n  - brain -> end\n"}}));
  const auto end = std::ranges::find(experiment.outputs, "end", &experiment::Output::node);
  ASSERT_NE(end, experiment.outputs.end());
  EXPECT_EQ(end->width, 2U);
}

const std::vector<std::string> kLinks = {
    "scan.out -> encoder.in [3]", "encoder.out -> brain.in [3]", "brain.out -> decoder.in [3]",
    "decoder.out -> wheels.in [2]"};

TEST_F(GoodFiles, WidthsFollowFromOthers) {
  EXPECT_EQ(texts(good(with({}))), kLinks);
  // The network's are in its file, the last one is that of the weights' rows.
  const Experiment experiment =
      good(with({{"encoder [3] -> brain [3] -> decoder [3]", "encoder -> brain -> decoder"}}));
  EXPECT_EQ(texts(experiment), kLinks);
  EXPECT_EQ(experiment.width("encoder", "in"), 3U);
  EXPECT_EQ(experiment.width("wheels", "in"), 2U);
}

TEST_F(GoodFiles, ConnectionsWrittenInSeveralWays) {
  EXPECT_EQ(texts(good(with({{"-> brain [3] -> decoder [3] -> wheels [2]",
                              "-> brain.in [ 3 ]->decoder[3]\n"
                              "  - {from: decoder.out, to: wheels.in, width: 2}"}}))),
            kLinks);
  EXPECT_EQ(texts(good(with({{"- scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]",
                              "- 'scan -> encoder.in [3] -> brain.in [3]'\n"
                              "  - from: brain\n    to: decoder\n"
                              "  - \"decoder.out -> wheels [2]\""}}))),
            kLinks);
}

TEST_F(GoodFiles, DelaysInTimeAndInTicks) {
  const Experiment experiment =
      good(with({{"encoder [3] -> brain [3]", "encoder [3, delay 5 ms] -> brain [delay 2 ticks]"},
                 {"-> decoder [3] -> wheels [2]",
                  "-> decoder [3,delay 1 tick]\n"
                  "  - {from: decoder, to: wheels, width: 2, delay: 0.003 s}"}}));
  EXPECT_THAT(texts(experiment),
              ElementsAre("scan.out -> encoder.in [3, 5]", "encoder.out -> brain.in [3, 2]",
                          "brain.out -> decoder.in [3, 1]", "decoder.out -> wheels.in [2, 3]"));
}

TEST_F(GoodFiles, BlanksInDelays) {
  EXPECT_THAT(texts(good(with({{"encoder [3] -> brain [3]",
                                "encoder [3, delay  2  ticks] -> brain [3,delay\t4ticks]"},
                               {"decoder [3]", "decoder [ delay 0.003s ]"}}))),
              ElementsAre("scan.out -> encoder.in [3, 2]", "encoder.out -> brain.in [3, 4]",
                          "brain.out -> decoder.in [3, 3]", "decoder.out -> wheels.in [2]"));
}

TEST_F(GoodFiles, TablesSayWidths) {
  // Rows are outputs, columns are inputs; a grid has centres and widths of its cells.
  const std::string chain = "encoder [3] -> brain [3] -> decoder [3] -> wheels [2]";
  EXPECT_EQ(texts(good(with({{chain, "encoder -> brain -> decoder -> wheels"}}))), kLinks);
  EXPECT_THAT(
      texts(good(with({{"nodes:\n",
                        "nodes:\n  mix: {node: connect, weights: [[1, 0, 1, 0, 1]]}\n"
                        "  sparse: {node: connect, weights: {rows: 3, columns: 1, entries: [[0, "
                        "0, 1]]}}\n"},
                       {"scan -> " + chain,
                        "scan -> mix -> sparse -> encoder -> brain -> decoder -> wheels"}}))),
      ElementsAre("scan.out -> mix.in [5]", "mix.out -> sparse.in [1]",
                  "sparse.out -> encoder.in [3]", kLinks[1], kLinks[2], kLinks[3]));
  more_["cells.json"] = "[[0, 0, 1, 1], [1, 0, 1, 1], [1, 1, 1, 1]]";
  EXPECT_THAT(
      texts(good(with({{"nodes:\n", "nodes:\n  cells: {node: discretize, grid: cells.json}\n"},
                       {"scan -> " + chain, "scan -> cells -> " + chain}}))),
      testing::IsSupersetOf({"scan.out -> cells.in [2]", "cells.out -> encoder.in [3]"}));
}

TEST_F(GoodFiles, APictureSaysItsWidth) {
  const Experiment experiment = good(
      with({{"robot: {simulator: mujoco}", "ros: 1"},
            {"nodes:\n",
             "nodes:\n  eye: {node: ros_sensor, topic: /camera, message: sensor_msgs/Image, image: "
             "{resize: [40, 30], channel: rgb, filter: on_off}}\n  grey: {node: rate_encoder}\n"},
            {"connections:\n", "connections:\n  - eye -> grey\n"}}));
  EXPECT_EQ(texts(experiment).front(), "eye.out -> grey.in [7200]");
}

TEST_F(GoodFiles, FieldsOfAnyMessage) {
  const Experiment experiment = good(with(
      {{"robot: {simulator: mujoco}", "ros: 1"},
       {"message: LaserScan",
        "message: sensor_msgs/msg/JointState, fields: [\"position[name=a]\", {path: "
        "\"velocity[0:2]\", "
        "range: [-1, 3], nan: zero}]"},
       {"message: Twist, fields: {linear.x: 0, angular.z: 1}",
        "message: sensor_msgs/JointState, fields: {\"effort[name=a]\": 0, \"velocity[0:2]\": 0}, "
        "limits: {\"velocity[0:2]\": [-1, 2]}"}}));
  const CommandMapping& mapping = experiment.node("wheels").mapping;
  ASSERT_EQ(mapping.fields.size(), 3U);
  EXPECT_EQ(mapping.message_type, "sensor_msgs/JointState");
  EXPECT_EQ(mapping.fields[2].field, "velocity[1]");
  EXPECT_EQ(mapping.fields[2].channel, 1U);
  EXPECT_EQ(mapping.fields[2].maximum, 2);
}

TEST_F(GoodFiles, AnOutputWithATableMayLeadNowhere) {
  const Experiment experiment =
      good(with({{"nodes:\n", "nodes:\n  other: {node: connect, weights: w.json}\n"},
                 {"connections:\n", "connections:\n  - scan -> other\n"}}));
  const auto output = std::ranges::find(experiment.outputs, "other", &experiment::Output::node);
  ASSERT_NE(output, experiment.outputs.end());
  EXPECT_EQ(output->width, 2U);
}

TEST_F(GoodFiles, AnOutputOfKnownWidthMayLeadNowhere) {
  for (const char* name : {"rate_encoder", "sigmoid", "argmax"}) {
    const Experiment experiment =
        good(with({{"nodes:\n", std::string("nodes:\n  other: {node: ") + name + "}\n"},
                   {"connections:\n", "connections:\n  - scan -> other\n"}}));
    EXPECT_EQ(experiment.outputs[0].width, std::string(name) == "argmax" ? 1U : 3U) << name;
  }
}

TEST_F(GoodFiles, EveryNodeIsRecordedUnlessItSaysOtherwise) {
  more_["brain.py"] = "import spikeloop\n";
  const Experiment experiment =
      good(with({{"rate_max: 200 Hz", "record: false"},
                 {"nodes:\n",
                  "nodes:\n  script: {simulator: python, script: brain.py, record: false, "
                  "gain: 2}\n"},
                 {"connections:\n", "connections:\n  - encoder -> script\n"}}));
  EXPECT_TRUE(experiment.node("scan").record);
  EXPECT_FALSE(experiment.node("encoder").record);
  EXPECT_FALSE(experiment.node("script").record);
  EXPECT_FALSE(experiment.node("script").written.contains("record")) << "no parameter of its";
}

TEST_F(GoodFiles, ACycleWithADelay) {
  const Experiment experiment =
      good(with({{"nodes:\n", "nodes:\n  a: {node: sigmoid}\n  b: {node: sigmoid}\n"},
                 {"connections:\n", "connections:\n  - a -> b [2] -> a [2, delay 1 tick]\n"}}));
  EXPECT_THAT(texts(experiment), testing::Contains("b.out -> a.in [2, 1]"));
}

TEST_F(GoodFiles, BlocksFlowsQuotesAndAliases) {
  more_["x.json"] = "[[1, 0, 0], [0, 1, 0]]";
  const Experiment experiment = good(with(
      {{"{node: ros_sensor, topic: /scan, message: LaserScan}",
        "\n    node: 'ros_sensor'\n    topic: \"/scan\"   # right to left\n"
        "    message: LaserScan"},
       {"{node: rate_encoder, rate_max: 200 Hz}", "{\"node\": rate_encoder, rate_max: \"200 Hz\"}"},
       {"w.json}", "&file x.json}"},
       {"linear.x: 0, angular.z: 1}}",
        "linear.x: {channel: 0, scale: 2}, angular.z: 1}, limits: {linear.x: [-1, 1]}}"}}));
  EXPECT_EQ(texts(experiment), kLinks);
  EXPECT_EQ(experiment.node("scan").parameters.text("topic"), "/scan");
  const auto& fields = experiment.node("wheels").mapping.fields;
  ASSERT_EQ(fields.size(), 2U);
  EXPECT_EQ(fields[0].scale, 2);
  EXPECT_EQ(fields[0].maximum, 1);
  EXPECT_EQ(fields[1].channel, 1U);
  EXPECT_FALSE(fields[1].maximum);
}

TEST_F(GoodFiles, NodesThatAreAliases) {
  const Experiment experiment =
      good(with({{"nodes:\n", "nodes:\n  a: &one {node: sigmoid, slope: 2}\n  b: *one\n"},
                 {"connections:\n", "connections:\n  - a -> b [2] -> a [2, delay 1 tick]\n"}}));
  EXPECT_EQ(experiment.node("b").parameters.number("slope"), 2);
}

TEST_F(GoodFiles, LinesAsOnWindowsAndAByteOrderMark) {
  std::string text = "\xEF\xBB\xBF" + with({});
  for (auto at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 2)) {
    text.replace(at, 1, "\r\n");
  }
  EXPECT_EQ(texts(good(text)), kLinks);
}

TEST_F(GoodFiles, WeightsInPlace) {
  const Experiment rows = good(with({{"w.json", "[[1, 0, 0], [0, 1e-3, -2]]"}}));
  EXPECT_EQ(rows.width("wheels", "in"), 2U);
  good(with({{"w.json", "{rows: 2, columns: 3, entries: [[0, 1, 0.5], [1, 2, -1]]}"}}));
  good(with({{"w.json", "uniform"}}));
  good(with({{"w.json", "blocks"}, {"wheels [2]", "wheels [3]"}}));
}

constexpr const char* kFlow =
    "{populations: {in: {model: input, size: 3}, r: {model: repeater, size: 3}}, connections: "
    "[{from: in, to: r, rule: one_to_one, delay: 1 ms}], output: [r]}";
constexpr const char* kBlock =
    "\n      populations:\n        in: {model: input, size: 3}\n"
    "        r: {model: repeater, size: 3}\n      connections:\n"
    "        - {from: in, to: r, rule: one_to_one, delay: 1 ms}\n      output: [r]";

TEST_F(GoodFiles, NetworksInPlace) {
  const std::string written = "brain: {simulator: builtin, network: net.yaml}";
  EXPECT_EQ(texts(good(with({{"net.yaml", kFlow}}))), kLinks);
  EXPECT_EQ(texts(good(with({{written, "brain:\n    simulator: builtin\n    network:" +
                                           std::string(kBlock)}}))),
            kLinks);
  EXPECT_EQ(texts(good(with({{written, "brain: {node: network, network: net.yaml}"}}))), kLinks);
}

TEST_F(GoodFiles, ANetworkWithoutInput) {
  const Experiment experiment =
      good(with({{"net.yaml",
                  "{populations: {n: {model: iaf_psc_exp, size: 3, parameters: {I_e: 500 pA}}}, "
                  "output: [n]}"},
                 {"scan -> encoder [3] -> brain [3]", "brain"},
                 {"  scan: {node: ros_sensor, topic: /scan, message: LaserScan}\n", ""},
                 {"  encoder: {node: rate_encoder, rate_max: 200 Hz}\n", ""}}));
  EXPECT_THAT(texts(experiment),
              ElementsAre("brain.out -> decoder.in [3]", "decoder.out -> wheels.in [2]"));
}

TEST_F(GoodFiles, ARecordingKnowsItsWidth) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "scan.h5").string();
  {
    record::Recorder recorder(path, "scan", {.tick = 1'000'000});
    recorder.signal_sink("out", 3, "1", {});
  }
  const std::string sensor = "{node: ros_sensor, topic: /scan, message: LaserScan}";
  const std::string playback = "{node: signal_playback, file: " + path + "}";
  EXPECT_EQ(
      texts(good(with({{sensor, playback}, {"encoder [3] -> brain [3]", "encoder -> brain"}}))),
      kLinks);
  const Files wide(
      with({{sensor, playback}, {"encoder [3] -> brain [3]", "encoder [4] -> brain"}}));
  EXPECT_THAT(
      read(wide, types_).faults,
      ElementsAre("x.yaml:12:13: widths differ: 'scan.out' has 3 channels, 'encoder.in' has "
                  "4, the connection says [4] [SL0306]"));
  const Files other(with({{sensor, "{node: signal_playback, stream: oot, file: " + path + "}"}}));
  EXPECT_THAT(
      read(other, types_).faults,
      ElementsAre(testing::HasSubstr("x.yaml:6:41: '" + path + "' has no signals called 'oot'")));
}

TEST_F(GoodFiles, RosNeedsNoRobot) {
  const Experiment experiment = good(with(
      {{"robot: {simulator: mujoco}", "ros: 1"}, {"/scan", "/laser"}, {"/cmd_vel", "/wheels"}}));
  EXPECT_EQ(experiment.ros, experiment::Ros::ros1);
  EXPECT_FALSE(experiment.robot);
}

TEST_F(GoodFiles, FieldsOfAMessage) {
  const Experiment experiment = good(with({{"/scan, message: LaserScan",
                                            "/odom, message: Odometry, fields: "
                                            "[pose.pose.position.x, twist.twist.linear.x, "
                                            "twist.twist.angular.z], initial: 0"}}));
  EXPECT_EQ(experiment.node("scan").parameters.text("message"), "nav_msgs/Odometry");
}

}  // namespace
}  // namespace spikeloop::test
