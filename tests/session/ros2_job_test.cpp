// A MUSIC job between topics of ROS 2: scans in, a matrix, commands out; and whatever kills its
// adapter, a zero command. These are safety deadlines: they may be asserted.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <memory>
#include <mutex>
#include <thread>

#include "spikeloop/core/pacer.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/ros2/session.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/ros2/log_lines.hpp"
#include "tests/support/child.hpp"
#include "tests/support/deadline.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::test;
using messages::Catalog;
using messages::Dialect;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Twist {
  double linear_x = 0;
  double angular_z = 0;
  TimeNs time = 0;  ///< monotonic clock, on arrival

  bool is_zero() const { return linear_x == 0 && angular_z == 0; }
};

/// Publishes /scan at 50 Hz and hears /cmd_vel.
class Robot {
 public:
  explicit Robot(const topics::Place& place)
      : session_({.node_name = "robot", .place = place}),
        scan_(session_.publisher("/scan", "sensor_msgs/LaserScan")),
        commands_(session_.subscriber({.topic = "/cmd_vel",
                                       .message_type = "geometry_msgs/Twist",
                                       .queue = 0,
                                       .take = [this](auto message) { take(message); }})),
        publisher_([this] {
          while (!ending_) {
            publish_scan();
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
          }
        }) {}
  ~Robot() {
    ending_ = true;
    publisher_.join();
  }

  std::vector<Twist> twists() const {
    const std::lock_guard lock(mutex_);
    return twists_;
  }

 private:
  void publish_scan() {
    const std::vector<double> ranges{3.5, 3.5, 1.5, 1.5};
    const std::vector<double> least{0.5};
    const std::vector<double> most{4.5};
    std::vector<std::byte> message;
    const messages::FieldValue values[] = {{ranges, {}}, {least, {}}, {most, {}}};
    messages::MessageWriter(Catalog::builtin(Dialect::ros2), "sensor_msgs/LaserScan",
                            {"ranges", "range_min", "range_max"})
        .write(values, message);
    scan_->publish(message);
  }

  void take(std::span<const std::byte> message) {
    const TimeNs now = wall_now();
    std::vector<double> values;
    linear_.read(message, values);
    angular_.read(message, values);
    const std::lock_guard lock(mutex_);
    twists_.push_back({values[0], values[1], now});
  }

  messages::FieldReader linear_{Catalog::builtin(Dialect::ros2), "geometry_msgs/Twist", "linear.x"};
  messages::FieldReader angular_{Catalog::builtin(Dialect::ros2), "geometry_msgs/Twist",
                                 "angular.z"};
  mutable std::mutex mutex_;
  std::vector<Twist> twists_;
  ros2::Session session_;
  std::unique_ptr<topics::RawPublisher> scan_;
  std::unique_ptr<topics::RawSubscriber> commands_;
  std::atomic<bool> ending_{false};
  std::thread publisher_;
};

class Ros2Job : public testing::Test {
 protected:
  Ros2Job() {
    directory_.write("twist.json",
                     R"({"message_type": "Twist", "mapping": {"linear.x": 0, "angular.z": 1},
                         "min": -1, "max": 1})");
    directory_.write("sum.json", "[[0.5, 0.5, 0, 0], [0, 0, 0.5, 0.5]]");
  }

  static std::string binary(const std::string& name) {
    return std::string(SPIKELOOP_BIN) + "/" + name;
  }

  /// scan [4] -> connect -> twist [2]
  static std::string scan_to_twist(const std::string& global, const std::string& sensor = "",
                                   const std::string& topic = "/scan") {
    return fmt::format(
        "music_timestep=0.002\nros=2\n{}\n"
        "[sensor]\nbinary=ros_sensor_adapter\nnp=1\nros_topic={}\nmessage_type=Laserscan\n{}\n"
        "[halves]\nbinary=connect_adapter\nnp=1\nweights_filename=sum.json\n"
        "[command]\nbinary=ros_command_adapter\nnp=1\nros_topic=/cmd_vel\n"
        "message_mapping_filename=twist.json\n"
        "sensor.out -> halves.in [4]\nhalves.out -> command.in [2]\n",
        global, topic, sensor);
  }

  Command launched(const std::string& text) {
    Command made;
    made.arguments = {binary("spikeloop"), "run", directory_.write("job.music", text)};
    made.environment = domain_.place();
    // No master may be asked for.
    made.environment.insert({{"ROS_MASTER_URI", "http://localhost:1"},
                             {"SPIKELOOP_STATUS", ""},
                             {"SPIKELOOP_OUT", ""},
                             {"SPIKELOOP_GUARD", ""}});
    made.directory = directory_.path().string();
    return made;
  }

  void run_until_it_drives(const std::string& text = scan_to_twist("stoptime=100")) {
    child_ = std::make_unique<Child>(launched(text));
    Twist driving;
    ASSERT_TRUE(eventually(60, [&] {
      const auto twists = robot_.twists();
      driving = twists.empty() ? driving : twists.back();
      return twists.size() > 3 && !driving.is_zero();
    })) << child_->output();
    EXPECT_EQ(driving.linear_x, 0.5);
    EXPECT_EQ(driving.angular_z, -0.5);
    ASSERT_GT(named("ros_command_ada"), 0);
  }

  /// The process of the job whose name, of which the kernel keeps 15 characters, is this.
  pid_t named(const std::string& name) const {
    for (const pid_t pid : child_->family()) {
      std::ifstream file("/proc/" + std::to_string(pid) + "/comm");
      std::string comm;
      if (std::getline(file, comm) && comm == name) {
        return pid;
      }
    }
    return -1;
  }

  void expect_zero_since(TimeNs begin, const char* what) {
    TimeNs zero = 0;
    eventually(10, [&] {
      for (const Twist& twist : robot_.twists()) {
        zero = zero == 0 && twist.time > begin && twist.is_zero() ? twist.time : zero;
      }
      return zero != 0;
    });
    const double ms = zero == 0 ? 1e9 : 1e-6 * static_cast<double>(zero - begin);
    std::printf("%s: zero command after %.1f ms\n", what, ms);
    EXPECT_LE(ms, deadline_.since(begin)) << what << "\n" << child_->output();
  }

  TemporaryDirectory directory_;
  FreeDomain domain_;
  Deadline deadline_;
  Robot robot_{domain_.place()};
  std::unique_ptr<Child> child_;
};

TEST_F(Ros2Job, adapter_killed) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives());
  const TimeNs begin = wall_now();
  kill(named("ros_command_ada"), SIGKILL);
  expect_zero_since(begin, "adapter killed");
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_THAT(outcome.text(), HasSubstr("spikeloop: warning: the robot on /cmd_vel is stopped: its "
                                        "command adapter 'command' has died"));
  EXPECT_EQ(outcome.exit_code, 128 + SIGKILL) << outcome.text();
}

TEST_F(Ros2Job, adapter_killed_whose_topic_has_another_name) {
  std::string text = scan_to_twist("stoptime=100");
  const std::string topic = "ros_topic=/cmd_vel";
  text.replace(text.find(topic), topic.size(), "ros_topic=/drive\nros_arguments=drive:=/cmd_vel");
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives(text));
  const TimeNs begin = wall_now();
  kill(named("ros_command_ada"), SIGKILL);
  expect_zero_since(begin, "adapter killed");
  EXPECT_THAT(child_->wait().text(), HasSubstr("the robot on /cmd_vel is stopped"));
}

/// Other nodes would miss those that end without a word after ten seconds.
TEST_F(Ros2Job, a_process_that_is_terminated_takes_leave) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives());
  ros2::Session session({.node_name = "looker", .place = domain_.place()});
  ASSERT_TRUE(eventually(20, [&] { return session.has_publishers("/diagnostics"); }));
  kill(named("ros_command_ada"), SIGTERM);
  EXPECT_TRUE(eventually(7, [&] { return !session.has_publishers("/diagnostics"); }));
  child_->wait();
}

TEST_F(Ros2Job, adapter_stopped) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives());
  const pid_t adapter = named("ros_command_ada");
  const TimeNs begin = wall_now();
  kill(adapter, SIGSTOP);
  expect_zero_since(begin, "adapter stopped");
  kill(adapter, SIGCONT);
  EXPECT_TRUE(
      child_->wait_for("the command adapter 'command' is heard again", std::chrono::seconds(10)));
  child_->signal(SIGINT);
  EXPECT_EQ(child_->wait().exit_code, 130);
}

TEST_F(Ros2Job, everything_killed_at_once) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives());
  const pid_t guard = named("spikeloop-guard");
  ASSERT_GT(guard, 0);
  const pid_t adapter = named("ros_command_ada");
  const auto processes = child_->family();
  const TimeNs begin = wall_now();
  kill(adapter, SIGKILL);
  for (const pid_t pid : processes) {
    if (pid != guard) {
      kill(pid, SIGKILL);
    }
  }
  expect_zero_since(begin, "launcher, mpirun and adapter killed");
  EXPECT_TRUE(eventually(20, [&] { return child_->family().empty(); }));
}

TEST_F(Ros2Job, interrupted) {
  ASSERT_NO_FATAL_FAILURE(run_until_it_drives());
  const TimeNs begin = wall_now();
  child_->signal(SIGINT);
  expect_zero_since(begin, "Ctrl-C");
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.text();
  EXPECT_THAT(outcome.text(), Not(HasSubstr("master")));
}

TEST_F(Ros2Job, a_topic_of_another_type) {
  ros2::Session session({.node_name = "console", .place = domain_.place()});
  const LogLines console(session);
  const auto error_on_rosout = [&] {
    return console.has(40, "ros_sensor_node", "topic '/cmd_vel' carries geometry_msgs/Twist");
  };
  test::Outcome outcome;
  // The console may know the program's publisher only after its end.
  for (int i = 0; i < 10 && !error_on_rosout(); ++i) {
    outcome = run(launched(scan_to_twist("stoptime=20", "", "/cmd_vel")));
    EXPECT_EQ(outcome.exit_code, 3) << outcome.text();
    eventually(1, error_on_rosout);
  }
  EXPECT_TRUE(error_on_rosout());
  EXPECT_THAT(outcome.text(),
              Fault("... topic '/cmd_vel' carries geometry_msgs/Twist, not sensor_msgs/LaserScan; "
                    "... write  message: geometry_msgs/Twist ... [SL0508] ..."));
}

TEST_F(Ros2Job, commands_that_nobody_takes) {
  std::string job = scan_to_twist("stoptime=4");
  job.replace(job.find("ros_topic=/cmd_vel"), 18, "ros_topic=/cmd");
  ros2::Session session({.node_name = "console", .place = domain_.place()});
  const LogLines console(session);
  const auto outcome = run(launched(job));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_TRUE(eventually(10, [&] {
    return console.has(30, "ros_command_node",
                       "no subscriber of geometry_msgs/Twist on topic '/cmd'");
  }));
  EXPECT_THAT(
      outcome.text(),
      HasSubstr("no subscriber of geometry_msgs/Twist on topic '/cmd'; the robot will not move. "
                "'ros2 topic info /cmd' shows subscribers and their types"));
  const auto driven = run(launched(scan_to_twist("stoptime=4")));
  EXPECT_EQ(driven.exit_code, 0) << driven.text();
  EXPECT_THAT(driven.text(), Not(HasSubstr("no subscriber of")));
}

TEST_F(Ros2Job, topics_that_a_robot_of_ours_does_not_use) {
  const auto said = [this](const std::string& sensor, const std::string& robot) {
    Command command = launched(scan_to_twist("stoptime=0.1", "", sensor));
    command.arguments.insert(command.arguments.end(), {"--robot", "--robot-arg=" + robot});
    return run(command).text();
  };
  EXPECT_THAT(said("/front/scan", "--scan-topic=/back/scan"),
              AllOf(HasSubstr("the robot sends /back/scan, and 'sensor' takes /front/scan: write  "
                              "--robot-arg=--scan-topic=/front/scan\n"),
                    Not(HasSubstr("the robot takes"))));
  EXPECT_THAT(said("/left/scan", "--topic-prefix=/left"),
              AllOf(HasSubstr("the robot takes /left/cmd_vel, and 'command' sends /cmd_vel: write  "
                              "--robot-arg=--cmd-topic=/cmd_vel\n"),
                    Not(HasSubstr("the robot sends"))));
}

/// As any node of ROS 2 has them.
TEST_F(Ros2Job, a_robot_has_its_topics_in_its_namespace) {
  ros2::Session session({.node_name = "looker", .place = domain_.place()});
  const auto commands = session.publisher("/arena/cmd_vel", "geometry_msgs/Twist");
  Command command = launched("");
  command.arguments = {binary("spikeloop-robot"),
                       "--ros",
                       "2",
                       "--ros-args",
                       "-r",
                       "__ns:=/arena",
                       "-r",
                       "scan:=lidar"};
  Child robot(command);
  for (const char* topic : {"/arena/lidar", "/arena/odom", "/clock"}) {
    EXPECT_TRUE(eventually(20, [&] { return session.has_publishers(topic); }))
        << topic << robot.output();
  }
  EXPECT_TRUE(eventually(20, [&] { return commands->has_subscribers(); })) << robot.output();
  EXPECT_FALSE(session.has_publishers("/odom"));
  robot.signal(SIGTERM);
  EXPECT_EQ(robot.wait().exit_code, 0);
}

/// Robots whose commands have been remapped do not share a hand.
TEST_F(Ros2Job, manual_commands_follow_the_commands) {
  ros2::Session session({.node_name = "hand", .place = domain_.place()});
  const auto hand = session.publisher("/arena/wheels_manual", "geometry_msgs/Twist");
  const auto shared = session.publisher("/cmd_vel_manual", "geometry_msgs/Twist");
  const auto named = session.publisher("/my_hand", "geometry_msgs/Twist");
  for (const bool with_rule : {true, false}) {
    Command command = launched(scan_to_twist("stoptime=100"));
    command.arguments.emplace_back("/cmd_vel:=/arena/wheels");
    if (with_rule) {
      command.arguments.emplace_back("/cmd_vel_manual:=/my_hand");
    }
    Child job(command);
    const topics::RawPublisher& heard = with_rule ? *named : *hand;
    EXPECT_TRUE(eventually(30, [&] { return heard.has_subscribers(); })) << job.output();
    EXPECT_FALSE(shared->has_subscribers());
    EXPECT_EQ(hand->has_subscribers(), !with_rule);
    job.signal(SIGINT);
    job.wait();
  }
}

TEST_F(Ros2Job, silence_and_names) {
  const auto silent = run(launched(scan_to_twist("stoptime=4", "", "/nothing")));
  EXPECT_EQ(silent.exit_code, 0) << silent.text();
  EXPECT_THAT(silent.text(), HasSubstr("no message on topic '/nothing' for 2 s; 'ros2 "
                                       "topic list' shows what there is with ROS_DOMAIN_ID=" +
                                       domain_.place().at("ROS_DOMAIN_ID")));
  Command remapped = launched(scan_to_twist("stoptime=4", "", "/nothing"));
  remapped.arguments.emplace_back("/nothing:=/front/scan");
  const std::string said = run(remapped).text();
  EXPECT_THAT(said, HasSubstr("no message on topic '/front/scan' for 2 s"));
  EXPECT_THAT(said, HasSubstr("no message arrived on topic '/front/scan'"));
  const auto wrong = run(launched(scan_to_twist("stoptime=1", "", "/front/2nd")));
  EXPECT_EQ(wrong.exit_code, 2) << wrong.text();
  EXPECT_THAT(wrong.text(), Fault("... '/front/2nd' ... ROS 2 topic name ... [SL0501] ..."));
}

}  // namespace
