// A real ROS master and a real robot for a test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/roscore.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::robot {

class RobotJob {
 public:
  void start_core() {
    core_.emplace();
    uri_ = core_->uri();
  }
  void set_master(const std::string& uri) { uri_ = uri; }

  test::Command robot(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), SPIKELOOP_ROBOT);
    return command(arguments);
  }
  test::Command probe(const std::string& seconds, const std::string& linear,
                      const std::string& angular) const {
    return command({"/usr/bin/python3", SPIKELOOP_PROBE, seconds, linear, angular});
  }
  test::Outcome run(const test::Command& command_line) const {
    return test::Child(command_line).wait();
  }
  const test::TemporaryDirectory& directory() const { return directory_; }
  std::string status_socket() const { return (directory_.path() / "status").string(); }

 private:
  test::Command command(const std::vector<std::string>& arguments) const {
    const std::string home = directory_.path().string();
    test::Command result;
    result.arguments = arguments;
    result.timeout = std::chrono::seconds(150);
    result.environment = {{"ROS_MASTER_URI", uri_},
                          {"ROS_HOSTNAME", "127.0.0.1"},
                          {"ROS_HOME", home},
                          {"ROS_LOG_DIR", home},
                          {"PYTHONUNBUFFERED", "1"},  // its lines come when it prints them
                          {"SPIKELOOP_STATUS", status_socket()}};
    result.directory = home;
    return result;
  }

  test::TemporaryDirectory directory_;
  std::string uri_;
  std::optional<test::RosCore> core_;
};

}  // namespace spikeloop::robot
