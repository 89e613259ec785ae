// The examples of ros_music_adapter and ros-music-adapters: a Braitenberg vehicle between a laser
// of 100 beams and a Twist, and a laser's neurons on a screen.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ranges>
#include <thread>

#include "older_job.hpp"
#include "tests/ros1/ros_peer.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/roscore.hpp"

namespace spikeloop::test {
namespace {

using testing::ElementsAre;

constexpr const char* kScan = "/vehicle/scan";
constexpr const char* kTwist = "/vehicle/wheels";
const std::string kCropped =
    "warning: topic '/vehicle/scan': a sensor_msgs/LaserScan brought 100 values, but the "
    "port has 20 channels: surplus values are left out, and channels without a value keep their "
    "last "
    "one; set the sensor's key 'beams' to 20 to resample scans by angle, or write [100] in its "
    "connection to have all";

/// What a regular train of spikes of this rate (Hz) makes of the kernel exp(-t/tau)/tau, from just
/// before a spike to just after it.
struct Trace {
  Trace(double rate, double tau)
      : high(1 / tau / (1 - std::exp(-1 / (rate * tau)))), low(high - 1 / tau) {}
  double high;
  double low;
};

std::string half_and_half() {
  std::string rows[2];
  for (int row = 0; row < 2; ++row) {
    for (int beam = 0; beam < 20; ++beam) {
      rows[row] += fmt::format("{}{}", beam == 0 ? "" : ", ", beam / 10 == row ? 0.1 : 0.0);
    }
  }
  return fmt::format("[[{}], [{}]]", rows[0], rows[1]);
}

// The sections, keys and widths of the vehicle of ros_music_adapter, for 3 s.
std::string vehicle(const std::string& first = "") {
  return first + R"(stoptime=3.
music_timestep=0.05
rtf=1
[sensor]
  binary=ros_sensor_adapter
  args=
  np=1
  ros_topic=/vehicle/scan
  message_type=Laserscan
  sensor_update_rate=20
[converge]
  binary=connect_adapter
  args=
  np=1
  weights_filename=vehicle_converge_weights.dat
[encoder]
  binary=rate_encoder
  args=
  np=1
  rate_min=2
  rate_max=150
[nest]
  binary=./vehicle_pyNEST.py
  args=-s 0.05 -t 3 -n 2
  np=1
[decoder]
  binary=linear_readout_decoder
  args=
  np=1
  tau=0.03
  weights_filename=vehicle_readout_weights.dat
[command]
  binary=ros_command_adapter
  args=
  np=1
  ros_topic=/vehicle/wheels
  message_mapping_filename=vehicle_twist_mapping.dat
  command_rate=10
sensor.out->converge.in[20]
converge.out->encoder.in[2]
encoder.out->nest.in[2]
nest.out->decoder.in[2]
decoder.out->command.in[2]
)";
}

// Those of the vehicle of ros-music-adapters, for 3 s.
std::string vehicle_of_rma2(const std::string& first = "") {
  return first + R"(stoptime=3.
music_timestep=0.001
[sensor]
  binary=ros_cont_adapter
  args=
  np=1
  ros_topic=/vehicle/scan
  message_type=Laserscan
  sensor_update_rate=20
  ros_node_name=laser_in_front
[converge]
  binary=cont_cont_adapter
  args=
  np=1
  weights_filename=vehicle_converge_weights.dat
[encoder]
  binary=rate_encoder
  args=
  np=1
  rate_min=2
  rate_max=150
[nest]
  binary=./vehicle_pyNEST.py
  args=
  np=1
[decoder]
  binary=linear_decoder
  args=
  np=1
  tau=0.03
[connect]
  binary=cont_cont_adapter
  args=
  np=1
  weights_filename=vehicle_readout_weights.dat
[command]
  binary=cont_ros_adapter
  args=
  np=1
  ros_topic=/vehicle/wheels
  message_mapping_filename=vehicle_twist_mapping.dat
  command_rate=20
  ros_node_name=wheels
sensor.out->converge.in[20]
converge.out->encoder.in[2]
encoder.out->nest.in[2]
nest.out->decoder.in[2]
decoder.out->connect.in[2]
connect.out->command.in[2]
)";
}

class OlderRosExample : public testing::Test {
 protected:
  ~OlderRosExample() override {
    publishing_ = false;
    if (publisher_.joinable()) {
      publisher_.join();
    }
  }

  /// Scans at 50 Hz: beams 0 to 9 at +0.5, 10 to 19 at -0.5 and, beyond the port, all free.
  void publish_scans() {
    robot_.listen_twist(kTwist);
    publisher_ = std::thread([this] {
      std::vector<float> beams(100, 4.5F);
      std::fill_n(beams.begin(), 10, 3.5F);
      std::fill_n(beams.begin() + 10, 10, 1.5F);
      while (publishing_) {
        robot_.publish_scan(kScan, beams, 0.5F, 4.5F);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    });
  }

  Outcome run_job(const std::string& text) {
    Command command = job_.command(text);
    command.environment["ROS_MASTER_URI"] = core_.uri();
    command.environment["ROS_HOSTNAME"] = "localhost";
    return run(command);
  }

  void write_vehicle(const std::string& readout, double limit) {
    job_.stand_in("vehicle_pyNEST.py");
    job_.write("vehicle_converge_weights.dat", half_and_half());
    job_.write("vehicle_readout_weights.dat", readout);
    job_.write("vehicle_twist_mapping.dat",
               fmt::format(R"({{"message_type": "Twist", "mapping": {{"angular.z": 1, "linear.x":
                               0}}, "max": {}, "min": {}}})",
                           limit, -limit));
  }

  /// Every command from 0.5 s after the first one on is that of the two rates, as the phase of the
  /// spikes lets it be: linear.x = forward (a + b), angular.z = turn (b - a).
  void expect_commands(double forward, double turn) {
    const Trace a(2 + (0.5 + 1) / 2 * 148, 0.03);
    const Trace b(2 + (-0.5 + 1) / 2 * 148, 0.03);
    auto twists = robot_.twists();
    ASSERT_FALSE(twists.empty());
    EXPECT_TRUE(twists.back().is_zero()) << "the robot was not stopped at the end";
    const auto driving = std::ranges::find_if(twists, [](const auto& t) { return !t.is_zero(); });
    ASSERT_NE(driving, twists.end());
    const auto begin = driving->time_ns + 500'000'000;
    std::erase_if(twists, [&](const auto& twist) { return twist.time_ns < begin; });
    ASSERT_FALSE(twists.empty());
    // MUSIC serves data_stamp in batches of 0.3 s, and the robot must not stop between them. A busy
    // machine may cause some stops.
    const auto batches = (twists.back().time_ns - begin) / 300'000'000;
    const auto stops = std::ranges::count_if(
        std::views::iota(std::size_t{1}, twists.size()),
        [&](std::size_t i) { return twists[i].is_zero() && !twists[i - 1].is_zero(); });
    EXPECT_LE(stops, 1 + batches / 2);
    std::erase_if(twists, [](const auto& twist) { return twist.is_zero(); });
    EXPECT_GT(twists.size(), 10U);
    constexpr double kRounding = 1e-9;
    for (const auto& twist : twists) {
      EXPECT_GE(twist.linear_x, forward * (a.low + b.low) - kRounding);
      EXPECT_LE(twist.linear_x, forward * (a.high + b.high) + kRounding);
      EXPECT_GE(twist.angular_z, turn * (b.low - a.high) - kRounding);
      EXPECT_LE(twist.angular_z, turn * (b.high - a.low) + kRounding);
    }
  }

  RosCore core_;
  ros_peer::Peer robot_{core_.uri()};
  OlderJob job_;
  std::atomic<bool> publishing_{true};
  std::thread publisher_;
};

TEST_F(OlderRosExample, VehicleOfRosMusicAdapterDrives) {
  write_vehicle("[[0.002, 0.002], [-0.004, 0.004]]", 2);
  publish_scans();
  const Outcome outcome = run_job(vehicle());
  expect_clean(outcome);
  EXPECT_THAT(warnings(outcome), ElementsAre(kCropped)) << outcome.text();
  expect_commands(0.002, 0.004);
}

TEST_F(OlderRosExample, VehicleOfRosMusicAdaptersDrives) {
  write_vehicle("[[0.004, 0.004], [-0.006, 0.006]]", 20);
  publish_scans();
  const Outcome outcome = run_job(vehicle_of_rma2());
  expect_clean(outcome);
  EXPECT_THAT(warnings(outcome), ElementsAre(kCropped)) << outcome.text();
  expect_commands(0.004, 0.006);
}

// As its users start it. Without the launcher there is no data_stamp connection beside the data.
TEST_F(OlderRosExample, VehicleDrivesUnderMusicsOwnLauncher) {
  write_vehicle("[[0.002, 0.002], [-0.004, 0.004]]", 2);
  publish_scans();
  Command command = music_job(job_.directory, 6, vehicle(), "vehicle.music");
  command.environment["PATH"] = std::string(SPIKELOOP_BIN) + ":" + getenv("PATH");
  command.environment["ROS_MASTER_URI"] = core_.uri();
  command.environment["ROS_HOSTNAME"] = "localhost";
  const Outcome outcome = run(command);
  expect_clean(outcome);
  EXPECT_THAT(warnings(outcome), ElementsAre(kCropped)) << outcome.text();
  expect_commands(0.002, 0.004);
}

TEST_F(OlderRosExample, StrictDoesNotCropAScan) {
  write_vehicle("[[0.002, 0.002], [-0.004, 0.004]]", 2);
  publish_scans();
  for (const std::string& text : {vehicle("strict=true\n"), vehicle_of_rma2("strict=true\n")}) {
    const Outcome outcome = run_job(text);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text();
    EXPECT_EQ(outcome.left_behind, 0);
    EXPECT_THAT(outcome.text(),
                Fault("... sensor_msgs/LaserScan ... 100 ... 20 ... [100] ... [SL0505] ..."));
  }
}

// The window with the principal components of a laser's neurons. Its encoder's rates were ignored.
TEST_F(OlderRosExample, NeuronsOfALaserReachTheirWindow) {
  const OlderJob job("examples/pca");
  job.stand_in("pca.py");
  job.program("ros_sensor_adapter", "../../ros_sensor_adapter");
  job.program("nef_encoder", "../../nef_encoder");
  publish_scans();
  Command command = job.command(R"(stoptime=2.
rtf=1.0
music_timestep=0.01
[sensor_laser]
  binary=../../ros_sensor_adapter
  args=
  np=1
  ros_topic=/vehicle/scan
  message_type=Laserscan
  sensor_update_rate=20
  ros_node_name=laser_in_front
[encoder_laser]
  binary=../../nef_encoder
  args=
  np=1
  rate_min=1
  rate_max=30
[pca_laser]
  binary=./pca.py
  args=
  np=1
sensor_laser.out->encoder_laser.in[100]
encoder_laser.out->pca_laser.in[60]
)");
  command.environment["ROS_MASTER_URI"] = core_.uri();
  command.environment["ROS_HOSTNAME"] = "localhost";
  const Outcome outcome = run(command);
  expect_clean(outcome);
  EXPECT_THAT(warnings(outcome), ElementsAre()) << outcome.text();
  EXPECT_THAT(outcome.text(), testing::ContainsRegex("stand-in: [1-9][0-9]* spikes, highest "
                                                     "channel [1-5]?[0-9]"));
}

TEST_F(OlderRosExample, BothSpellingsOfTheCommandRate) {
  write_vehicle("[[0.004, 0.004], [-0.006, 0.006]]", 20);
  publish_scans();
  std::string text = vehicle_of_rma2();
  text.insert(text.find("  command_rate=20"), "  command_update_rate=10\n");
  const Outcome outcome = run_job(text);
  expect_clean(outcome);
  EXPECT_THAT(outcome.text(),
              Fault("... command: warning: 'command_rate' and 'command_update_rate' ... leave out "
                    "'command_rate', which cont_ros_adapter ignores ... [SL0102]\n ..."));
}

}  // namespace
}  // namespace spikeloop::test
