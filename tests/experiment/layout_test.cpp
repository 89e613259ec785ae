// The key `layout`: which nodes share a process, and what that does to delays.
#include "spikeloop/experiment/layout.hpp"

#include <gmock/gmock.h>

#include "spikeloop/experiment/music_job.hpp"
#include "tests/experiment/experiment_text.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using experiment::Experiment;
using testing::ElementsAre;

constexpr const char* kLoop = R"(experiment: loop
duration: 1 s
ros: 2
layout: {vision: [scan, encoder], control: [decoder, wheels]}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: LaserScan}
  encoder: {node: rate_encoder}
  decoder: {node: linear_readout, weights: uniform}
  wheels: {node: ros_command, topic: /cmd_vel, message: Twist, fields: {linear.x: 0}}
connections:
  - scan -> encoder [3] -> decoder [3] -> wheels [1]
)";

/// As `--layout NAME`.
experiment::Overrides with_layout(const char* name) {
  return {.settings = {{"layout", name, "--layout"}}};
}

class LayoutTest : public testing::Test {
 protected:
  /// The text with a part replaced.
  Read read_with(const std::string& node, const std::string& other,
                 const experiment::Overrides& overrides = {}) {
    std::string text = kLoop;
    text.replace(text.find(node), node.size(), other);
    files_ = std::make_unique<Files>(
        text, std::map<std::string, std::string>{{"brain.py", "import spikeloop\n"}});
    return read(*files_, types_, overrides);
  }
  std::vector<std::string> faults_of(const std::string& layout) {
    return read_with("{vision: [scan, encoder], control: [decoder, wheels]}", layout).faults;
  }
  Experiment loop(const std::string& node = "duration", const std::string& other = "duration") {
    const Read result = read_with(node, other);
    EXPECT_THAT(result.faults, testing::IsEmpty());
    return experiment::with_layout_delays(result.experiment);
  }
  /// "scan.data_stamp -> wheels.data_stamp 3": every edge with its delay.
  static std::vector<std::string> texts(const Experiment& experiment) {
    std::vector<std::string> result;
    for (const experiment::Connection& edge : edges(experiment)) {
      result.push_back(edge.from + " -> " + edge.to + " " +
                       std::to_string(edge.delay_ticks.value()));
    }
    return result;
  }
  static std::vector<std::string> names(const Experiment& experiment) {
    std::vector<std::string> result;
    for (const experiment::Process& process : experiment.layout.processes) {
      result.push_back(process.name);
    }
    return result;
  }

  experiment::NodeTypes types_;
  std::unique_ptr<Files> files_;
};

TEST_F(LayoutTest, NodesRunInTheProcessesThatAreWritten) {
  const Experiment experiment = loop();
  EXPECT_THAT(names(experiment), ElementsAre("vision", "control"));
  EXPECT_EQ(process_of(experiment, "encoder"), "vision");
  EXPECT_EQ(process_of(experiment, "wheels"), "control");
  EXPECT_TRUE(needs_music(experiment));
  EXPECT_EQ(name_of(experiment.layout), "vision, control");
}

// No way leads back: spikes take no time, and values a tick.
TEST_F(LayoutTest, ForwardSpikesTakeNoTimeAndValuesATick) {
  EXPECT_THAT(texts(loop()),
              ElementsAre("scan.out -> encoder.in 0", "encoder.out -> decoder.in 0",
                          "decoder.out -> wheels.in 0", "scan.data_stamp -> wheels.data_stamp 1",
                          "scan.data_stamp -> wheels.sensor_0 1"));
  EXPECT_THAT(texts(loop("[scan, encoder], control: [", "[scan], control: [encoder, ")),
              ElementsAre("scan.out -> encoder.in 1", "encoder.out -> decoder.in 0",
                          "decoder.out -> wheels.in 0", "scan.data_stamp -> wheels.data_stamp 1",
                          "scan.data_stamp -> wheels.sensor_0 1"));
}

constexpr const char* kCycle = R"(duration: 1 s
sync: unpaced
layout: {one: [squash, encoder], two: [decoder], three: [trace]}
nodes:
  squash: {node: sigmoid}
  encoder: {node: rate_encoder}
  decoder: {node: linear_readout, weights: uniform}
  trace: {node: rate_window, window: 20 ms}
connections:
  - squash -> encoder [1] -> decoder [1] -> squash [1]
  - encoder -> trace [1]
)";

// MUSIC's latencies around a cycle add up to a tick a process; a process beside it has no need.
TEST_F(LayoutTest, AroundACycleBothTakeMore) {
  const std::string text = kCycle;
  const auto experiment_of = [&](const std::string& delay) {
    std::string with_delay = text;
    with_delay.replace(text.find("-> squash [1]"), 13, "-> squash [1" + delay + "]");
    files_ = std::make_unique<Files>(with_delay);
    const Read result = read(*files_, types_);
    EXPECT_THAT(result.faults, testing::IsEmpty());
    return result.experiment;
  };
  const Experiment experiment = experiment::with_layout_delays(experiment_of(", delay 5 ticks"));
  std::vector<bool> cycles;
  for (const experiment::Process& process : experiment.layout.processes) {
    cycles.push_back(process.in_cycle);
  }
  EXPECT_THAT(cycles, ElementsAre(true, true, false));
  EXPECT_THAT(texts(experiment),
              ElementsAre("squash.out -> encoder.in 0", "encoder.out -> decoder.in 1",
                          "decoder.out -> squash.in 5", "encoder.out -> trace.in 0"));
  EXPECT_EQ(music_delay(experiment, experiment.connections[2]), 3U)
      << "two ticks wait in the graph";
  const MusicFile file = experiment::process_job(experiment, "", {}).file;
  EXPECT_EQ(key(file, "two", "spike_delay"), "1");
  EXPECT_EQ(key(file, "two", "signal_delay"), "2");
  EXPECT_EQ(key(file, "three", "spike_delay"), "none");
  try {
    experiment::with_layout_delays(experiment_of(", delay 2 ticks"));
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(
        files_->plain(error.what()),
        "x.yaml:10:45: continuous values from 'decoder.out' to 'squash.in' take at least 3 "
        "ticks between processes, and here it is 2 ticks; write  delay 3 ticks, leave it out, "
        "or use the fused layout [SL0310]");
  }
}

TEST_F(LayoutTest, AJobHasASectionAProcess) {
  const Experiment experiment = loop();
  const MusicFile file = experiment::process_job(experiment, "", {{"about", "{}"}}).file;
  EXPECT_THAT(file.labels(), ElementsAre("vision", "control"));
  EXPECT_NO_THROW(check_structure(file));
  EXPECT_THAT(to_text(file),
              testing::HasSubstr("vision.encoder__out -> control.encoder__out [3]\n"
                                 "vision.scan__data_stamp -> control.scan__data_stamp [1]\n"));
  EXPECT_EQ(key(file, "vision", "clock_master"), "true");
  EXPECT_EQ(key(file, "control", "clock_master"), "false") << "it waits for the other one's data";
  EXPECT_EQ(key(file, "vision", "about"), "{}");
  EXPECT_EQ(key(file, "control", "about"), "{}") << "a replay is told to all";
  EXPECT_EQ(key(file, "control", "spike_delay"), "none");
}

TEST_F(LayoutTest, TheCommandLineGoesBeforeTheFile) {
  const Read result = read_with("duration", "duration", with_layout("fused"));
  EXPECT_THAT(names(result.experiment), ElementsAre("experiment"));
  EXPECT_FALSE(needs_music(result.experiment));
  EXPECT_EQ(name_of(result.experiment.layout), "fused");
}

TEST_F(LayoutTest, SeparateIsAProcessANode) {
  const Read result = read_with("duration", "duration", with_layout("separate"));
  EXPECT_THAT(result.faults, testing::IsEmpty());
  EXPECT_EQ(name_of(result.experiment.layout), "separate");
  EXPECT_THAT(names(result.experiment), ElementsAre("scan", "encoder", "decoder", "wheels"));
  const Experiment experiment = experiment::with_layout_delays(result.experiment);
  EXPECT_THAT(texts(experiment),
              ElementsAre("scan.out -> encoder.in 1", "encoder.out -> decoder.in 0",
                          "decoder.out -> wheels.in 1", "scan.data_stamp -> wheels.data_stamp 2",
                          "scan.data_stamp -> wheels.sensor_0 1"));
  EXPECT_EQ(key(experiment::process_job(experiment, "", {}).file, "wheels", "settings"),
            R"([["layout","separate","--layout"]])");
}

// The simulator's process counts as any other: the data of `control` do not come back to it.
TEST_F(LayoutTest, ASimulatorMakesNoCycle) {
  const Experiment experiment = loop(
      "connections:\n",
      "  brain: {simulator: python, script: brain.py}\nconnections:\n  - encoder -> brain [3]\n");
  for (const experiment::Process& process : experiment.layout.processes) {
    EXPECT_FALSE(process.in_cycle) << process.name;
  }
}

TEST_F(LayoutTest, SaysWhatIsWrong) {
  EXPECT_THAT(faults_of("{vision: [scan, encodre], control: [decoder, wheels]}"),
              ElementsAre("x.yaml:4:25: key 'layout': there is no node 'encodre'; did you mean "
                          "'encoder'? [SL0301]"));
  EXPECT_THAT(faults_of("{vision: [scan], control: [decoder, wheels]}"),
              ElementsAre("x.yaml:4:9: key 'layout': node 'encoder' is in no process; add it to "
                          "one of them [SL0601]"));
  EXPECT_THAT(faults_of("{vision: [scan, encoder], control: [decoder, scan, wheels]}"),
              ElementsAre("x.yaml:4:54: key 'layout': node 'scan' is in process 'vision' already; "
                          "write it once [SL0601]"));
  EXPECT_THAT(faults_of("{\"the eye\": [scan, encoder], control: [decoder, wheels]}"),
              ElementsAre(Fault("x.yaml:4:21: key 'layout': 'the eye' is not the name of a "
                                "process; write letters, digits and '_' [SL0106]")));
  EXPECT_THAT(faults_of("{robot: [scan, encoder], control: [decoder, wheels]}"),
              ElementsAre("x.yaml:4:17: key 'layout': 'robot' is the process of the robot; give "
                          "this one another name [SL0601]"));
  const Read robot = read_with(
      "connections:\n", "  robot: {node: clip}\nconnections:\n  - scan -> robot -> decoder [3]\n",
      with_layout("separate"));
  EXPECT_THAT(robot.faults,
              testing::Contains(Fault("x.yaml:10:3: key 'layout': 'robot' ... [SL0601]")));
  EXPECT_THAT(faults_of("{}"),
              ElementsAre("x.yaml:4:9: key 'layout': there are no processes; write  layout: "
                          "{vision: [camera], control: [encoder, decoder, wheels]}, or leave it "
                          "out [SL0601]"));
  EXPECT_THAT(
      faults_of("parallel"),
      ElementsAre("x.yaml:4:9: key 'layout': 'parallel' is neither fused nor separate nor a "
                  "map; write  fused, separate, or a map such as  layout: {vision: [camera], "
                  "control: [encoder, decoder, wheels]} [SL0105]"));
}

TEST_F(LayoutTest, OneProcessMeetsARobotThatIsStepped) {
  EXPECT_THAT(read_with("ros: 2", "ros: 2\nsync: lockstep").faults,
              ElementsAre("x.yaml:5:9: key 'layout': sync: lockstep needs all sensors and commands "
                          "in one process; put them together, or write  sync: realtime [SL0601]"));
  EXPECT_THAT(
      read_with("ros: 2", "robot: {simulator: mujoco}").faults,
      ElementsAre(Fault("x.yaml:4:9: key 'layout': a robot without ROS ... ros: 2 ... [SL0601]")));
}

}  // namespace
}  // namespace spikeloop::test
