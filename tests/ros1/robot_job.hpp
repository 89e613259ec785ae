// A MUSIC job between a robot's topics, under the real mpirun: scans in, a matrix, commands out.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "ros_peer.hpp"
#include "tests/support/deadline.hpp"
#include "tests/support/music_job.hpp"
#include "tests/support/roscore.hpp"

namespace spikeloop::test {

class RobotJob : public testing::Test {
 protected:
  RobotJob() {
    directory_.write("twist.json",
                     R"({"message_type": "Twist", "mapping": {"linear.x": 0, "angular.z": 1},
                         "min": -1, "max": 1})");
    directory_.write("sum.json", "[[0.5, 0.5, 0, 0], [0, 0, 0.5, 0.5]]");
  }
  ~RobotJob() override { stop_publishing(); }

  static std::string binary(const std::string& name) {
    return std::string(SPIKELOOP_BIN) + "/" + name;
  }

  /// scan [4] -> connect -> twist [2], with data_stamp beside it.
  std::string scan_to_twist(const std::string& global, const std::string& command_keys = "") {
    return fmt::format(
        "music_timestep=0.002\n{0}\n"
        "[command]\nbinary={1}\nnp=1\nros_topic=/cmd_vel\n"
        "message_mapping_filename={4}/twist.json\npipeline_ticks=1\n{5}\n"
        "[halves]\nbinary={2}\nnp=1\nweights_filename={4}/sum.json\n"
        "[sensor]\nbinary={3}\nnp=1\nros_topic=/scan\nmessage_type=Laserscan\n"
        "sensor.out -> halves.in [4]\nhalves.out -> command.in [2]\n"
        "sensor.data_stamp -> command.data_stamp [1]\n",
        global, binary("ros_command_adapter"), binary("connect_adapter"),
        binary("ros_sensor_adapter"), directory_.path().string(), command_keys);
  }

  Command command(int processes, const std::string& text) {
    Command made = music_job(directory_, processes, text);
    made.environment["ROS_MASTER_URI"] = core_.uri();
    made.environment["ROS_HOSTNAME"] = "localhost";
    return made;
  }

  void start(const std::string& text, int processes = 3) {
    robot_.listen_twist("/cmd_vel");
    child_ = std::make_unique<Child>(command(processes, text));
  }

  /// Scans at 50 Hz until told otherwise; the matrix makes (0.5, -0.5) of them.
  void publish_scans() {
    publishing_.store(true);
    publisher_ = std::thread([this] {
      while (publishing_.load()) {
        robot_.publish_scan("/scan", {3.5f, 3.5f, 1.5f, 1.5f}, 0.5f, 4.5f);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    });
  }
  void stop_publishing() {
    publishing_.store(false);
    if (publisher_.joinable()) {
      publisher_.join();
    }
  }

  /// Waits until the robot drives on commands of the job.
  ::testing::AssertionResult drives() {
    const bool good = ros_peer::eventually(60, [&] {
      const auto twists = robot_.twists();
      return twists.size() > 3 && !twists.back().is_zero();
    });
    return good ? ::testing::AssertionSuccess()
                : ::testing::AssertionFailure() << "no commands:\n"
                                                << child_->output();
  }

  /// Time in ms from `begin` to the first zero after it.
  double time_to_zero(std::int64_t begin, double limit_s) {
    std::int64_t zero = 0;
    ros_peer::eventually(limit_s, [&] {
      for (const ros_peer::Twist& twist : robot_.twists()) {
        if (twist.time_ns > begin && twist.is_zero()) {
          zero = twist.time_ns;
          return true;
        }
      }
      return false;
    });
    return zero == 0 ? 1e9 : 1e-6 * static_cast<double>(zero - begin);
  }

  /// The process of the job that runs this program.
  pid_t process(const std::string& program) const {
    for (const pid_t pid : child_->family()) {
      std::error_code error;
      const auto path =
          std::filesystem::read_symlink("/proc/" + std::to_string(pid) + "/exe", error);
      if (path.filename() == program) {
        return pid;
      }
    }
    return -1;
  }

  TemporaryDirectory directory_;
  RosCore core_;
  ros_peer::Peer robot_{core_.uri()};
  Deadline deadline_;
  std::unique_ptr<Child> child_;
  std::atomic<bool> publishing_{false};
  std::thread publisher_;
};

}  // namespace spikeloop::test
