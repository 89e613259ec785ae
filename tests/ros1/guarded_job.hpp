// A job between a robot's topics as `spikeloop run` starts it, with a guard beside it.
#pragma once

#include <algorithm>
#include <fstream>

#include "robot_job.hpp"

namespace spikeloop::test {

class GuardedJob : public RobotJob {
 protected:
  Command launched(const std::string& text, const std::string& file = "job.music") {
    Command made;
    made.arguments = {binary("spikeloop"), "run", directory_.write(file, text)};
    made.environment = {{"SPIKELOOP_STATUS", ""},
                        {"SPIKELOOP_OUT", ""},
                        {"SPIKELOOP_GUARD", ""},
                        {"ROS_MASTER_URI", core_.uri()},
                        {"ROS_HOSTNAME", "localhost"}};
    made.directory = directory_.path().string();
    return made;
  }

  /// The same job as scan_to_twist, to an array on another topic.
  static std::string scan_to_motors(const std::string& global) {
    return fmt::format(
        "music_timestep=0.002\n{0}\n"
        "[command]\nbinary={1}\nnp=1\nros_topic=/motors\nmessage_type=FloatArray\n"
        "[sensor]\nbinary={2}\nnp=1\nros_topic=/scan\nmessage_type=Laserscan\n"
        "sensor.out -> command.in [4]\n",
        global, binary("ros_command_adapter"), binary("ros_sensor_adapter"));
  }

  void run_until_it_drives(const std::string& global) {
    publish_scans();
    robot_.listen_twist("/cmd_vel");
    child_ = std::make_unique<Child>(launched(scan_to_twist(global)));
    ASSERT_TRUE(drives());
    ASSERT_GT(named("ros_command_ada"), 0);
  }

  /// The process of the job whose name, of which the kernel keeps 15 characters, is this.
  static pid_t named(const std::string& name, const Child& child) {
    for (const pid_t pid : child.family()) {
      std::ifstream file("/proc/" + std::to_string(pid) + "/comm");
      std::string comm;
      if (std::getline(file, comm) && comm == name) {
        return pid;
      }
    }
    return -1;
  }
  pid_t named(const std::string& name) const { return named(name, *child_); }

  /// What `rosnode kill` does to the node whose name begins so. Returns when it did.
  std::int64_t shut_down(const std::string& node) const {
    Command command;
    command.arguments = {"/usr/bin/python3", "-c",
                         "import sys, time, xmlrpc.client as rpc\n"
                         "master = rpc.ServerProxy(sys.argv[1])\n"
                         "state = master.getSystemState('/test')[2]\n"
                         "names = {name for kind in state for _, nodes in kind for name in nodes}\n"
                         "for name in names:\n"
                         "    if name.startswith(sys.argv[2]):\n"
                         "        uri = master.lookupNode('/test', name)[2]\n"
                         "        print(time.monotonic_ns(), flush=True)\n"
                         "        rpc.ServerProxy(uri).shutdown('/test', 'by the test')\n",
                         core_.uri(), node};
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
    return std::atoll(outcome.out.c_str());
  }

  /// The adapter first: others that die have it stop the robot itself. The guard is stopped
  /// meanwhile: the launcher would say what it says. Returns when it began.
  std::int64_t kill_all_but_guard() const {
    const pid_t guard = named("spikeloop-guard");
    std::vector<pid_t> processes = child_->family();
    EXPECT_EQ(std::erase(processes, guard), 1u);
    const pid_t adapter = named("ros_command_ada");
    std::ranges::stable_partition(processes, [&](pid_t pid) { return pid == adapter; });
    kill_all({child_->pid()}, SIGSTOP);  // the launcher would continue the guard
    const auto begin = ros_peer::monotonic_now();
    kill_all({guard}, SIGSTOP);
    EXPECT_TRUE(ros_peer::eventually(10, [&] { return is_stopped(guard); }));
    kill_all(processes, SIGKILL);
    await_launchers_death();
    kill_all({guard}, SIGCONT);
    return begin;
  }
  /// It stays a zombie.
  void await_launchers_death() const {
    siginfo_t gone{};
    waitid(P_PID, static_cast<id_t>(child_->pid()), &gone, WEXITED | WNOWAIT);
  }
  /// Threads go on after SIGSTOP until one of them takes it.
  static bool is_stopped(pid_t pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
    std::string stat;
    return std::getline(file, stat) && stat.find(") T ") != std::string::npos;
  }
  static void kill_all(const std::vector<pid_t>& processes, int signal) {
    for (const pid_t pid : processes) {
      ASSERT_GT(pid, 1);
      kill(pid, signal);
    }
  }

  void expect_zero_since(std::int64_t begin, const char* what) {
    const double ms = time_to_zero(begin, 10);
    std::printf("%s: zero command after %.1f ms\n", what, ms);
    EXPECT_LE(ms, deadline_.since(begin)) << what << "\n" << child_->output();
  }

  /// What the job that drives is told when a node of its is shut down by somebody.
  auto expect_zero_after_shut_down(const std::string& node) {
    const auto begin = shut_down(node);
    const double ms = time_to_zero(begin, 10);
    std::printf("%s shut down by rosnode kill: zero command after %.1f ms\n", node.c_str(), ms);
    EXPECT_LE(ms, 1000);
    auto outcome = child_->wait();
    EXPECT_EQ(outcome.exit_code, 3) << outcome.text();
    return outcome;
  }

  /// 2 s are the guard's, 1 s is for a machine that does other things too.
  void expect_nothing_left(std::int64_t begin) {
    EXPECT_TRUE(ros_peer::eventually(20, [&] { return child_->family().empty(); }));
    const double s = 1e-9 * static_cast<double>(ros_peer::monotonic_now() - begin);
    std::printf("everything gone after %.2f s\n", s);
    EXPECT_LE(s, 3);
    EXPECT_TRUE(robot_.twists().back().is_zero());
  }

  /// How many have come when no more come.
  std::size_t settled_number_of_commands() {
    std::size_t number = 0;
    while (number != robot_.twists().size()) {
      number = robot_.twists().size();
      std::this_thread::sleep_for(std::chrono::milliseconds(400));
    }
    return number;
  }

  /// How many of the commands from number `first` on are the guard's.
  std::ptrdiff_t guards_commands(std::size_t first = 0) {
    const auto twists = robot_.twists();
    return std::count_if(twists.begin() + static_cast<std::ptrdiff_t>(first), twists.end(),
                         [](const ros_peer::Twist& twist) {
                           return twist.publisher.starts_with("/spikeloop_guard");
                         });
  }

  /// From the first zero since `begin` on, the robot is not driven before `duration_ns` have
  /// passed.
  void expect_quiet_after_zero(std::int64_t begin, std::int64_t duration_ns) {
    bool stopped = false;
    for (const ros_peer::Twist& twist : robot_.twists()) {
      stopped = stopped || (twist.time_ns > begin && twist.is_zero());
      EXPECT_TRUE(!stopped || twist.is_zero() || twist.time_ns - begin >= duration_ns)
          << "driven after " << twist.time_ns - begin << " ns";
    }
  }

  /// A machine that keeps the adapter from its work for 200 ms gives the guard cause to stop it.
  void expect_no_zero_of_the_guard(const Outcome& outcome) {
    settled_number_of_commands();
    const auto twists = robot_.twists();
    ASSERT_FALSE(twists.empty());
    EXPECT_TRUE(twists.back().is_zero());
    if (!outcome.says("has not been heard")) {
      EXPECT_EQ(guards_commands(), 0) << "the guard adds nothing";
      EXPECT_FALSE(outcome.says("guard")) << outcome.text();
    }
  }
};

}  // namespace spikeloop::test
