// The adapters in real jobs: what goes in, what comes out, and when.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "robot_job.hpp"
#include "spikeloop/record/reader.hpp"
#include "tests/support/fault.hpp"

namespace {

using namespace spikeloop::test;
using ros_peer::eventually;
using ros_peer::Twist;
using testing::HasSubstr;

class AdapterTest : public RobotJob {
 protected:
  std::string pass_through(const std::string& sensor_keys, const std::string& command_keys,
                           int width = 2) {
    return fmt::format(
        "music_timestep=0.002\nstoptime=100\n"
        "[command]\nbinary={0}\nnp=1\nros_topic=/cmd_vel\n{3}\n"
        "[sensor]\nbinary={1}\nnp=1\nros_topic=/in\n{2}\n"
        "sensor.out -> command.in [{4}]\n",
        binary("ros_command_adapter"), binary("ros_sensor_adapter"), sensor_keys, command_keys,
        width);
  }
  std::string twist_keys() const {
    return "message_mapping_filename=" + directory_.path().string() + "/twist.json\n";
  }
  void finish() {
    child_->signal(SIGUSR1);
    const auto outcome = child_->wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
    EXPECT_EQ(outcome.left_behind, 0);
  }
  /// A busy machine that holds up a tick may make a zero leave: the robot is stopped.
  bool nothing_drives() const {
    const auto twists = robot_.twists();
    return std::ranges::all_of(twists, [](const auto& twist) { return twist.is_zero(); });
  }
  /// Publishes until the last command is near this one.
  bool reaches(double linear_x, double angular_z, const std::function<void()>& publish) {
    return eventually(60, [&] {
      publish();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      const auto twists = robot_.twists();
      return !twists.empty() && std::fabs(twists.back().linear_x - linear_x) < 1e-12 &&
             std::fabs(twists.back().angular_z - angular_z) < 1e-12;
    });
  }
};

TEST_F(AdapterTest, scan_to_twist) {
  publish_scans();
  start(scan_to_twist("stoptime=100"));
  ASSERT_TRUE(drives());
  EXPECT_EQ(robot_.twists().back().linear_x, 0.5);
  EXPECT_EQ(robot_.twists().back().angular_z, -0.5);
  finish();
}

TEST_F(AdapterTest, a_mapping_file_scales_what_a_sensor_takes) {
  directory_.write("sensor.json", R"({"fields": [{"path": "angular.z", "scale": 0.5, "offset": 0.1},
                                      {"path": "linear.x", "range": [-4, 4]}]})");
  start(pass_through("message_type=geometry_msgs/Twist\nsensor_mapping_filename=" +
                         directory_.path().string() + "/sensor.json",
                     twist_keys()),
        2);
  EXPECT_TRUE(reaches(0.35, 0.25, [&] { robot_.publish_twist("/in", 1, 0.5); }));
  finish();
}

TEST_F(AdapterTest, a_change_leaves_at_once_and_rest_is_repeated) {
  start(pass_through("message_type=Twist", twist_keys() + "command_rate=10"), 2);
  ASSERT_TRUE(reaches(0.25, 0, [&] { robot_.publish_twist("/in", 0.25, 0); }));
  // Nothing new: a repetition every 0.1 s.
  const std::size_t before = robot_.twists().size();
  ASSERT_TRUE(eventually(20, [&] { return robot_.twists().size() >= before + 20; }));
  const auto repeated = robot_.twists();
  const double seconds =
      1e-9 * static_cast<double>(repeated.back().time_ns - repeated[before].time_ns);
  EXPECT_GE(seconds / static_cast<double>(repeated.size() - 1 - before), 0.09);
  // A change within the deadband of 1 % of [-1, 1] waits for its repetition, a larger one does not.
  const auto begin = ros_peer::monotonic_now();
  robot_.publish_twist("/in", 0.75, 0);
  ASSERT_TRUE(eventually(10, [&] { return robot_.twists().back().linear_x == 0.75; }));
  const double ms = 1e-6 * static_cast<double>(robot_.twists().back().time_ns - begin);
  std::printf("message in to command out: %.2f ms\n", ms);
  finish();
}

TEST_F(AdapterTest, commands_keep_their_distance) {
  start(pass_through("message_type=Twist",
                     twist_keys() + "command_rate=0\nmin_interval=0.05\ndeadband=0"),
        2);
  double value = 0;
  ASSERT_TRUE(eventually(60, [&] {
    value = value > 0.9 ? 0.1 : value + 0.001;
    robot_.publish_twist("/in", value, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
    return robot_.twists().size() > 100;
  }));
  const auto twists = robot_.twists();
  const double mean_ms = 1e-6 *
                         static_cast<double>(twists.back().time_ns - twists.front().time_ns) /
                         static_cast<double>(twists.size() - 1);
  EXPECT_GE(mean_ms, 49);
  finish();
}

TEST_F(AdapterTest, values_are_limited_and_faults_are_never_sent) {
  start(pass_through("message_type=FloatArray", twist_keys()), 2);
  ASSERT_TRUE(reaches(1, -0.5, [&] { robot_.publish_array("/in", {7, -0.5}); }));
  ASSERT_TRUE(reaches(0, 0, [&] { robot_.publish_array("/in", {std::nan(""), -0.5}); }));
  ASSERT_TRUE(reaches(0.5, -0.5, [&] { robot_.publish_array("/in", {0.5, -0.5}); }));
  ASSERT_TRUE(reaches(0, 0, [&] { robot_.publish_array("/in", {HUGE_VAL, -0.5}); }));
  finish();
  for (const Twist& twist : robot_.twists()) {
    EXPECT_TRUE(std::isfinite(twist.linear_x) && std::isfinite(twist.angular_z));
  }
}

/// The name that the port data_stamp has in the file.
class DataStampTest : public AdapterTest, public testing::WithParamInterface<const char*> {};

INSTANTIATE_TEST_SUITE_P(Names, DataStampTest, testing::Values("data_stamp", "pace"));

// Two continuous hops: data arrive two ticks after their message was taken, and so must data_stamp.
TEST_P(DataStampTest, arrives_with_its_data) {
  robot_.listen_twist("/cmd_vel");
  Command job =
      command(3, fmt::format("music_timestep=0.002\nstoptime=100\n"
                             "[command]\nbinary={0}\nnp=1\nros_topic=/cmd_vel\n{3}\n"
                             "record=true\npipeline_ticks=1\n"
                             "[halves]\nbinary={1}\nnp=1\nweights_filename={4}/sum.json\n"
                             "[sensor]\nbinary={2}\nnp=1\nros_topic=/in\nmessage_type=FloatArray\n"
                             "sensor.out -> halves.in [4]\nhalves.out -> command.in [2]\n"
                             "sensor.{5} -> command.{5} [1]\n",
                             binary("ros_command_adapter"), binary("connect_adapter"),
                             binary("ros_sensor_adapter"), twist_keys(), directory_.path().string(),
                             GetParam()));
  job.environment["SPIKELOOP_OUT"] = directory_.path().string();
  child_ = std::make_unique<Child>(job);
  double value = -1;
  ASSERT_TRUE(eventually(60, [&] {
    value += 1.0 / 1024;
    robot_.publish_array("/in", {value, value, value, value});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return robot_.twists().size() > 60;
  }));
  finish();
  const std::string file = directory_.path().string() + "/command.h5";
  const auto data = spikeloop::record::read_signal(file, "command");
  const auto data_stamp = spikeloop::record::read_signal(file, "data_stamp");
  EXPECT_GT(data.times.size(), 50u);
  EXPECT_GT(data_stamp.times.size(), 50u);
  // The programs end one after another: what is on its way then may come from one of them alone.
  const auto [at, of_data_stamp] = std::ranges::mismatch(data.times, data_stamp.times);
  EXPECT_TRUE(at == data.times.end() || of_data_stamp == data_stamp.times.end())
      << "message " << at - data.times.begin() << " came at " << *at << ", its age at "
      << *of_data_stamp;
}

// A decoder gives 0 before the first spike; a mapping's offset would make a command of it.
TEST_F(AdapterTest, no_command_from_an_offset_before_the_first_message) {
  directory_.write("turn.json", R"({"message_type": "Twist",
                                    "mapping": {"angular.z": {"channel": 0, "offset": 0.2}}})");
  robot_.listen_twist("/cmd_vel");
  child_ = std::make_unique<Child>(command(
      4, fmt::format("music_timestep=0.002\nstoptime=100\n"
                     "[command]\nbinary={0}/ros_command_adapter\nnp=1\nros_topic=/cmd_vel\n"
                     "message_mapping_filename=turn.json\npipeline_ticks=1\n"
                     "[decoder]\nbinary={0}/linear_readout_decoder\nnp=1\nweights=one_to_one\n"
                     "[encoder]\nbinary={0}/rate_encoder\nnp=1\n"
                     "[sensor]\nbinary={0}/ros_sensor_adapter\nnp=1\nros_topic=/scan\n"
                     "message_type=Laserscan\n"
                     "sensor.out -> encoder.in [1]\nencoder.out -> decoder.in [1]\n"
                     "decoder.out -> command.in [1]\nsensor.data_stamp -> command.data_stamp [1]\n",
                     SPIKELOOP_BIN)));
  ASSERT_TRUE(eventually(60, [&] { return robot_.publishers("/cmd_vel") == 1; }));
  EXPECT_TRUE(child_->wait_for(
      "sensor: warning: no message on topic '/scan' for 2 s; 'rostopic list' shows what there is "
      "with ROS_MASTER_URI=http",
      std::chrono::seconds(60)))
      << child_->output();
  EXPECT_TRUE(nothing_drives());
  robot_.publish_scan("/scan", {4.0f}, 0.5f, 4.5f);
  EXPECT_TRUE(eventually(20, [&] {
    robot_.publish_scan("/scan", {4.0f}, 0.5f, 4.5f);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return !nothing_drives();
  }));
  finish();
}

// A laser that sees nothing at all is as good as one that is silent.
TEST_F(AdapterTest, messages_without_a_reading_do_not_keep_the_data_young) {
  publish_scans();
  start(scan_to_twist("stoptime=100", "max_age=0.4"));
  ASSERT_TRUE(drives());
  stop_publishing();
  const float nan = std::nanf("");
  EXPECT_TRUE(eventually(10, [&] {
    robot_.publish_scan("/scan", {nan, nan, nan, 0.0f}, 0.5f, 4.5f);
    return child_->wait_for("brought no reading", std::chrono::milliseconds(20)) &&
           child_->wait_for("max_age", std::chrono::milliseconds(20)) &&
           robot_.twists().back().is_zero();
  }));
  finish();
  EXPECT_THAT(child_->output(), HasSubstr("sensor: warning: topic '/scan': a sensor_msgs/LaserScan "
                                          "brought no reading; the channels keep what they had"));
  EXPECT_THAT(child_->output(),
              Fault("... command: warning: the robot is stopped: ... max_age, ..."));
}

// What is recorded is what leaves: after scale, offset and limits.
TEST_F(AdapterTest, records_the_commands_fields) {
  directory_.write("twist.json",
                   R"({"message_type": "Twist",
                       "mapping": {"linear.x": {"channel": 0, "scale": 2, "offset": 0.25, "max": 1},
                                   "angular.z": {"channel": 1, "scale": -1}}})");
  robot_.listen_twist("/cmd_vel");
  Command job = command(2, pass_through("message_type=FloatArray", twist_keys() + "record=true"));
  job.environment["SPIKELOOP_OUT"] = directory_.path().string();
  child_ = std::make_unique<Child>(job);
  ASSERT_TRUE(reaches(0.5, -0.75, [&] { robot_.publish_array("/in", {0.125, 0.75}); }));
  ASSERT_TRUE(reaches(1, 0.5, [&] { robot_.publish_array("/in", {0.5, -0.5}); }));
  finish();
  const auto recorded =
      spikeloop::record::read_signal(directory_.path().string() + "/command.h5", "command");
  ASSERT_EQ(recorded.times.size(), 2u);
  EXPECT_EQ(recorded.values, (std::vector<double>{0.5, -0.75, 1, 0.5}));
}

TEST_F(AdapterTest, no_command_before_the_first_message) {
  start(pass_through("message_type=Twist", twist_keys()), 2);
  ASSERT_TRUE(eventually(60, [&] { return robot_.publishers("/cmd_vel") == 1; }));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_TRUE(nothing_drives());
  finish();
}

// The older program's first LaserScan example wrote past its buffer: 100 beams on 20 channels.
TEST_F(AdapterTest, all_channels_without_a_mapping_file_and_a_long_scan) {
  robot_.listen_array("/cmd_vel");
  child_ = std::make_unique<Child>(command(2, pass_through("message_type=Laserscan", "", 20)));
  ASSERT_TRUE(eventually(60, [&] {
    robot_.publish_scan("/in", std::vector<float>(100, 2.5f), 0.5f, 4.5f);
    return child_->wait_for("a sensor_msgs/LaserScan", std::chrono::milliseconds(10)) &&
           !robot_.arrays().empty();
  }));
  EXPECT_EQ(robot_.arrays().front(), std::vector<double>(20, 0.0));
  finish();
  EXPECT_THAT(child_->output(),
              Fault("... sensor: warning: topic '/in': a sensor_msgs/LaserScan "
                    "brought 100 values, but the port has 20 channels: ... [100] ..."));
  EXPECT_THAT(
      child_->output(),
      HasSubstr("command: warning: section 'command' has no message_mapping_filename, which "
                "says which channel goes to which field; write it, or "
                "message_type=FloatArray to send all channels; a Float64MultiArray of all "
                "channels is sent"));
}

// The names and defaults of ros-music-adapters: topic /cmd_vel, mapping.json beside the job, and
// the key command_rate, which its program did not read.
TEST_F(AdapterTest, the_names_of_ros_music_adapters) {
  directory_.write("mapping.json", R"({"message_type": "Twist", "mapping": {"linear.x": 0},
                                       "min": -1, "max": 1})");
  start(fmt::format("music_timestep=0.002\nstoptime=100\n"
                    "[command]\nbinary={0}\nnp=1\ncommand_rate=20\n"
                    "[sensor]\nbinary={1}\nnp=1\nros_topic=/in\nros_node_name=observations\n"
                    "sensor_update_rate=30\nmessage_type=Float64MultiArray\n"
                    "sensor.out -> command.in [1]\n",
                    binary("cont_ros_adapter"), binary("ros_cont_adapter")),
        2);
  ASSERT_TRUE(reaches(0.5, 0, [&] { robot_.publish_array("/in", {0.5}); }));
  const auto nodes = robot_.nodes();
  EXPECT_EQ(std::count(nodes.begin(), nodes.end(), "/observations"), 1);
  finish();
}

// Two command adapters with the older programs' fixed default name ended each other.
TEST_F(AdapterTest, two_adapters_of_a_kind) {
  start(
      fmt::format("music_timestep=0.002\nstoptime=100\n"
                  "[a]\nbinary={0}\nnp=1\nros_topic=/cmd_vel\n{2}\n"
                  "[b]\nbinary={0}\nnp=1\nros_topic=/cmd_vel\n{2}\n"
                  "[sensor]\nbinary={1}\nnp=1\nros_topic=/in\nmessage_type=Twist\n"
                  "ros_node_name=my_sensor\n"
                  "sensor.out -> a.in [2]\nsensor.out -> b.in [2]\n",
                  binary("ros_command_adapter"), binary("ros_sensor_adapter"), twist_keys()));
  ASSERT_TRUE(reaches(0.5, 0, [&] { robot_.publish_twist("/in", 0.5, 0); }));
  EXPECT_TRUE(eventually(20, [&] { return robot_.publishers("/cmd_vel") == 2; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(robot_.publishers("/cmd_vel"), 2);
  const auto nodes = robot_.nodes();
  EXPECT_EQ(std::count(nodes.begin(), nodes.end(), "/my_sensor"), 1);
  EXPECT_EQ(std::count_if(
                nodes.begin(), nodes.end(),
                [](const std::string& name) { return name.rfind("/ros_command_node_", 0) == 0; }),
            2);
  finish();
}

}  // namespace
