// Event cameras in experiment files: keys, widths, what is wrong, and the same as a MUSIC job.
#include <fmt/format.h>

#include "spikeloop/experiment/music_job.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "tests/experiment/wrong_file.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using experiment::Experiment;
using testing::ElementsAre;
using testing::IsEmpty;

/// @param head in place of  ros: 2
std::string events(const std::string& keys, const std::string& width = " [48]",
                   const std::string& head = "ros: 2") {
  return fmt::format(
      "duration: 1 s\n{}\nnodes:\n"
      "  eye: {{node: ros_event_sensor, topic: /events, message: EventPacket{}}}\n"
      "  count: {{node: rate_window, window: 100 ms}}\n"
      "  go: {{node: ros_command, topic: /go, message: std_msgs/Float64MultiArray}}\n"
      "connections:\n  - eye -> count{} -> go\n",
      head, keys, width);
}

class Events : public testing::Test {
 protected:
  Experiment good(const std::string& text) {
    files_.push_back(std::make_unique<Files>(text));
    Read result = read(*files_.back(), types_);
    EXPECT_THAT(result.faults, IsEmpty()) << text;
    return std::move(result.experiment);
  }
  std::vector<std::string> faults(const std::string& text) {
    return read(Files(text), types_).faults;
  }

  experiment::NodeTypes types_;
  std::vector<std::unique_ptr<Files>> files_;
};

TEST_F(Events, DefaultsAreThoseOfTheProgram) {
  const Experiment experiment = good(events(""));
  const Parameters& keys = experiment.node("eye").parameters;
  EXPECT_EQ(keys.text("message"), "event_camera_msgs/EventPacket");
  EXPECT_EQ(keys.text("polarity"), "both");
  EXPECT_EQ(keys.integer("downsample"), 1);
  EXPECT_DOUBLE_EQ(keys.number("latency"), 0.04);
  EXPECT_EQ(keys.number("refractory"), 0);
  EXPECT_EQ(keys.number("timeout"), 0);
}

TEST_F(Events, ARegionSaysTheWidth) {
  const auto width = [&](const std::string& keys) {
    return good(events(keys, "")).connections[0].width;
  };
  EXPECT_EQ(width(", roi: [100, 60, 128, 64]"), 128U * 64U);
  EXPECT_EQ(width(", roi: [100, 60, 13, 5], downsample: 4"), 4U * 2U);
  EXPECT_EQ(width(", roi: \"100,60,13,5\", polarity: split"), 2U * 13U * 5U);
}

TEST_F(Events, WhatIsWrongIsSaid) {
  EXPECT_THAT(
      faults(events(", roi: [0, 0, 4]")),
      ElementsAre(Fault(
          "x.yaml:4:76: key 'roi': '[0,0,4]' ... 4 ... roi: [100, 60, 128, 128] ... [SL0105]")));
  EXPECT_THAT(faults(events(", roi: [0, 0, 4, 4], downsample: 2")),
              ElementsAre(Fault("x.yaml:8:12: a region of 4 x 4 pixels makes 4 channels "
                                "(polarity=both, downsample=2) ... 48 ... [4] ... [SL0505]")));
  EXPECT_THAT(faults(events(", polarity: spilt")),
              ElementsAre(Fault("x.yaml:4:81: key 'polarity': 'spilt' ... 'split' ... both, on, "
                                "off, split ... [SL0205]")));
  EXPECT_THAT(faults(events(", latency: 20")),
              ElementsAre("x.yaml:4:80: node 'eye': key 'latency': 20 has no unit; write for "
                          "example  latency: 20 ms [SL0202]"));
  EXPECT_THAT(faults(events(", region: [0, 0, 4, 4]")),
              ElementsAre("x.yaml:4:71: node 'eye': unknown key 'region'; known: topic, message, "
                          "polarity, downsample, roi, latency, refractory, timeout [SL0103]"));
  std::string scan = events("");
  scan.replace(scan.find("EventPacket"), 11, "LaserScan");
  EXPECT_THAT(
      faults(scan),
      ElementsAre(Fault("x.yaml:4:58: message type 'sensor_msgs/LaserScan' ... "
                        "dvs_msgs/EventArray, event_camera_msgs/EventPacket ... [SL0504]")));
}

TEST_F(Events, SomebodyMustSendThem) {
  const auto rest = testing::HasSubstr("/go");  // nobody takes commands there, either
  EXPECT_THAT(
      faults(events("", " [48]", "robot: {simulator: mujoco}")),
      ElementsAre(Fault("x.yaml:4:40: key 'topic': the robot in this process has no event camera "
                        "that sends /events; write  ros: 2  for one that has, or take the changes "
                        "of its pictures (docs/images.md, \"Events from frames\") [SL0507]"),
                  rest));
  EXPECT_THAT(faults(events("", " [48]", "seed: 1")),
              ElementsAre(Fault("x.yaml:4:3: node 'eye': ... /events ... ros: 2, or  robot: "
                                "{simulator: mujoco} ... [SL0507]"),
                          rest));
}

TEST_F(Events, SilenceStopsTheRobotOnlyWhenThatIsWritten) {
  const Experiment silent = good(events(""));
  EXPECT_THAT(watched_sensors(silent, silent.node("go")), IsEmpty());
  const Experiment watched = good(events(", timeout: 300 ms"));
  const auto sensors = watched_sensors(watched, watched.node("go"));
  ASSERT_EQ(sensors.size(), 1U);
  EXPECT_EQ(sensors[0].topic, "/events");
  EXPECT_EQ(sensors[0].timeout, 300'000'000);
}

TEST_F(Events, AreAProgramInAnExportedJob) {
  const Experiment experiment =
      good(events(", polarity: split, downsample: 2, roi: [1, 2, 3, 4], latency: 20 ms, "
                  "refractory: 1 ms, timeout: 300 ms",
                  ""));
  const experiment::MusicJob job = experiment::music_job(experiment, "folder");
  const MusicSection& eye = job.file.section("eye");
  const auto key = [&](const MusicSection& section, const char* name) {
    const MusicKey* found = job.file.find_key(section, name);
    return found == nullptr ? "none" : found->value;
  };
  EXPECT_EQ(key(eye, "binary"), "ros_event_sensor_adapter");
  EXPECT_EQ(key(eye, "ros"), "2");
  EXPECT_EQ(key(eye, "ros_topic"), "/events");
  EXPECT_EQ(key(eye, "message_type"), "event_camera_msgs/EventPacket");
  EXPECT_EQ(key(eye, "polarity"), "split");
  EXPECT_EQ(key(eye, "downsample"), "2");
  EXPECT_EQ(key(eye, "roi"), "1,2,3,4");
  EXPECT_EQ(key(eye, "latency"), "20 ms");
  EXPECT_EQ(key(eye, "refractory"), "1 ms");
  // No data_stamp tells of a camera: the command listens itself.
  EXPECT_EQ(key(job.file.section("go"), "sensor_topics"),
            "/events:event_camera_msgs/EventPacket:0.300000000");
}

}  // namespace
}  // namespace spikeloop::test
