// What the adapters say when they cannot run.
#include <gmock/gmock.h>

#include "robot_job.hpp"
#include "tests/support/fault.hpp"

namespace {

using namespace spikeloop::test;
using testing::HasSubstr;

class ErrorTest : public RobotJob {
 protected:
  Outcome outcome_of(const std::string& sensor_keys, const std::string& command_keys,
                     const std::string& global = "", int width = 2) {
    Command job =
        command(2, fmt::format("music_timestep=0.002\nstoptime=1\n{4}\n"
                               "[command]\nbinary={0}\nnp=1\n{3}\n"
                               "[sensor]\nbinary={1}\nnp=1\n{2}\nsensor.out -> command.in [{5}]\n",
                               binary("ros_command_adapter"), binary("ros_sensor_adapter"),
                               sensor_keys, command_keys, global, width));
    job.environment["ROS_MASTER_URI"] = uri_.empty() ? core_.uri() : uri_;
    return run(job);
  }
  const std::string sensor_ = "ros_topic=/in\nmessage_type=Twist\n";
  const std::string command_ =
      "ros_topic=/cmd_vel\nmessage_mapping_filename=" + directory_.path().string() +
      "/twist.json\n";
  std::string uri_;
};

TEST_F(ErrorTest, no_master) {
  const spikeloop::ReservedPort port;
  uri_ = "http://localhost:" + port.text();
  const auto outcome = outcome_of(sensor_, command_, "master_timeout=0.5");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text();
  EXPECT_THAT(outcome.text(),
              Fault("... " + uri_ +
                    " ... 500 ms (Connection refused) ... ROS_MASTER_URI ... [SL0701] ..."));
  EXPECT_FALSE(outcome.timed_out);
}

// The wrong port in ROS_MASTER_URI: a node answers, but it is no master.
TEST_F(ErrorTest, a_node_is_no_master) {
  uri_ = robot_.node_uri();
  // Without these keys the command adapter subscribes, too, and may be refused first.
  const auto outcome = outcome_of(sensor_, command_ + "\nemergency_stop=none\noverride=none");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text();
  EXPECT_THAT(outcome.text(), Fault("... " + uri_ +
                                    " refuses ... '/in' ... no ROS master; set "
                                    "ROS_MASTER_URI ... [SL0701] ..."));
  EXPECT_FALSE(outcome.timed_out);
}

TEST_F(ErrorTest, missing_and_wrong_keys) {
  EXPECT_THAT(outcome_of("message_type=Twist", command_).text(),
              HasSubstr("key 'ros_topic' is missing; write for example  ros_topic=/scan"));
  EXPECT_THAT(outcome_of(sensor_, "").text(),
              HasSubstr("key 'ros_topic' is missing; write for example  ros_topic=/cmd_vel"));
  EXPECT_THAT(outcome_of("ros_topic=/in", command_).text(),
              HasSubstr("key 'message_type' is missing; write for example  "
                        "message_type=sensor_msgs/LaserScan"));
  EXPECT_THAT(outcome_of("ros_topic=/in\nmessage_type=Laserscam", command_).text(),
              HasSubstr("Laserscam"));
  EXPECT_THAT(outcome_of(sensor_ + "initial=many", command_).text(),
              Fault("... key 'initial': 'many' ... 'none' ... [SL0201] ..."));
  EXPECT_THAT(
      outcome_of(sensor_, command_ + "command_rate=10\ncommand_update_rate=20", "strict=true")
          .text(),
      Fault("... 'command_rate' and 'command_update_rate' ... leave out 'command_update_rate' ... "
            "[SL0102] ..."));
}

TEST_F(ErrorTest, what_stops_the_robot) {
  const auto said = [&](const std::string& keys) {
    const auto outcome = outcome_of(sensor_, command_ + keys);
    EXPECT_EQ(outcome.exit_code, 2) << keys;
    return outcome.text();
  };
  EXPECT_THAT(said("emergency_stop="), HasSubstr("key 'emergency_stop': there is no topic"));
  EXPECT_THAT(said("emergency_stop=/cmd_vel"),
              Fault("... key 'emergency_stop': /cmd_vel ... or none ... [SL0506] ..."));
  EXPECT_THAT(said("override=/cmd_vel"),
              Fault("... key 'override': /cmd_vel ... or none ... [SL0506] ..."));
  EXPECT_THAT(said("override=/emergency_stop"),
              Fault("... key 'override': /emergency_stop ... or none ... [SL0506] ..."));
  EXPECT_THAT(said("emergency_stop_field=dat"), HasSubstr("did you mean 'data'?"));
  EXPECT_THAT(said("emergency_stop_message=std_msgs/Bol"),
              HasSubstr("unknown message type 'std_msgs/Bol'"));
  EXPECT_THAT(said("sensor_topics=/in:geometry_msgs/Twist"),
              HasSubstr("sensor_topics: '/in:geometry_msgs/Twist' is not a topic with its type and "
                        "timeout in s; write sensor_topics=/scan:sensor_msgs/LaserScan:0.5, and "
                        "others behind a comma"));
  EXPECT_THAT(said("sensor_topics=/in:geometry_msgs/Twist:0"),
              HasSubstr("is not a topic with its type"));
  EXPECT_THAT(said("sensor_topics=/in:geometry_msgs/Twits:1"), HasSubstr("Twits"));
}

TEST_F(ErrorTest, widths_and_channels) {
  // Defect 9 of the older program: a mapping index beyond the port was read out of bounds.
  const auto narrow = outcome_of(sensor_, command_, "", 1);
  EXPECT_EQ(narrow.exit_code, 2) << narrow.text();
  EXPECT_THAT(narrow.text(), HasSubstr("angular.z"));
  EXPECT_THAT(outcome_of(sensor_, command_, "strict=true", 3).text(),
              Fault("... geometry_msgs/Twist ... 2 ... 3 ... [2] ... [SL0505] ..."));
}

TEST_F(ErrorTest, sensor_mapping_files_are_explained) {
  const auto error = [&](const std::string& keys) {
    return outcome_of("ros_topic=/in\nmessage_type=Twist\n" + keys, command_, "", 2).text();
  };
  EXPECT_THAT(error("sensor_mapping_filename=nowhere.json"), Fault("... 'nowhere.json' ..."));
  EXPECT_THAT(
      error("fields=linear.x\nsensor_mapping_filename=nowhere.json"),
      HasSubstr("'fields' and 'sensor_mapping_filename' both say what to take; leave one of "
                "them out"));
}

TEST_F(ErrorTest, strict_wants_a_mapping_file) {
  EXPECT_THAT(
      outcome_of(sensor_, "ros_topic=/cmd_vel", "strict=true").text(),
      HasSubstr("section 'command' has no message_mapping_filename, which says which channel "
                "goes to which field; write it, or message_type=FloatArray to send all "
                "channels"));
}

TEST_F(ErrorTest, the_bare_program_has_no_direction) {
  const auto outcome = run(command(
      2,
      fmt::format("stoptime=1\n[command]\nbinary={0}\nnp=1\n{2}\n[sensor]\nbinary={1}\nnp=1\n{3}\n"
                  "sensor.out -> command.in [2]\n",
                  binary("spikeloop-ros"), binary("ros_sensor_adapter"), command_, sensor_)));
  EXPECT_THAT(outcome.text(),
              HasSubstr("binary=spikeloop-ros does not say which way messages go; write "
                        "binary=ros_sensor_adapter, ros_event_sensor_adapter or "
                        "ros_command_adapter"));
}

TEST_F(ErrorTest, help_names_every_key) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> programs = {
      {"ros_sensor_adapter",
       {"ros_topic", "message_type", "sensor_update_rate", "initial", "sensor_mapping_filename"}},
      {"ros_command_adapter",
       {"command_rate", "deadband", "watchdog", "max_age", "cmd_vel", "emergency_stop"}},
      {"ros_cont_adapter", {"ros_topic", "message_type"}},
      {"cont_ros_adapter",
       {"/cmd_vel ", "mapping.json ", "command_update_rate       Hz          20 "}},
      {"ros_event_sensor_adapter",
       {"ros_topic", "message_type", "polarity", "downsample", "roi", "latency", "refractory",
        "sensor_update_rate", "event.out -> "}},
      {"spikeloop-ros", {"ros_sensor_adapter", "ros_event_sensor_adapter", "ros_command_adapter"}}};
  for (const auto& [program, words] : programs) {
    const auto outcome = run({.arguments = {binary(program), "--help"}});
    EXPECT_EQ(outcome.exit_code, 0);
    for (const std::string& word : words) {
      EXPECT_THAT(outcome.out, HasSubstr(word)) << program;
    }
  }
}

}  // namespace
