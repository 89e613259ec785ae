// An experiment file that is right, and everything that is said about one that is not.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {

inline constexpr const char* kGood = R"(experiment: table
duration: 1 s
tick: 1 ms
robot: {simulator: mujoco}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: LaserScan}
  encoder: {node: rate_encoder, rate_max: 200 Hz}
  brain: {simulator: builtin, network: net.yaml}
  decoder: {node: linear_readout, tau: 30 ms, weights: w.json}
  wheels: {node: ros_command, topic: /cmd_vel, message: Twist, fields: {linear.x: 0, angular.z: 1}}
connections:
  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]
)";
inline constexpr const char* kNetwork =
    "populations:\n  input: {model: input, size: 3}\n  r: {model: repeater, size: 3}\n"
    "connections:\n  - {from: input, to: r, rule: one_to_one, delay: 1 ms}\noutput: [r]\n";

/// The good file with these parts replaced; an empty part is the whole file.
inline std::string with(const std::vector<std::pair<std::string, std::string>>& instead) {
  std::string text = kGood;
  for (const auto& [node, other] : instead) {
    const auto place = node.empty() ? 0 : text.find(node);
    if (place == std::string::npos) {
      ADD_FAILURE() << "the good file has no " << node;
      return text;
    }
    text.replace(place, node.empty() ? text.size() : node.size(), other);
  }
  return text;
}

/// x.yaml, and the files that it names.
class Files {
 public:
  explicit Files(const std::string& text, const std::map<std::string, std::string>& more = {}) {
    directory_.write("net.yaml", kNetwork);
    directory_.write("w.json", "[[1, 0, 0], [0, 1, 0]]");
    for (const auto& [name, content] : more) {
      std::filesystem::create_directories((directory_.path() / name).parent_path());
      directory_.write(name, content);
    }
    path_ = directory_.write("x.yaml", text);
  }
  const std::string& path() const { return path_; }
  std::string directory() const { return directory_.path().string(); }

  /// Without where the files happen to lie.
  std::string plain(std::string text) const {
    text = replaced(text, directory() + "/", "");
    text = replaced(text, directory(), "DIR");
    return replaced(text, std::filesystem::current_path().string(), "CWD");
  }

 private:
  static std::string replaced(std::string text, const std::string& node, const std::string& by) {
    for (auto at = text.find(node); at != std::string::npos; at = text.find(node, at + by.size())) {
      text.replace(at, node.size(), by);
    }
    return text;
  }

  TemporaryDirectory directory_;
  std::string path_;
};

/// The experiment, and what is wrong with it.
struct Read {
  std::vector<std::string> faults;
  experiment::Experiment experiment;
};

/// Topics of the vehicle in a world without lamps, or of an arm with two motors; no widths.
inline experiment::RobotView view_of(const experiment::Experiment& experiment) {
  const experiment::Robot& robot = *experiment.robot;
  if (robot.model) {
    return {.topics = {{"/joint_states", "sensor_msgs/JointState", {}, {"shoulder", "elbow"}},
                       {"/sensors/tip", "std_msgs/Float64MultiArray"},
                       {"/joint_commands",
                        "sensor_msgs/JointState",
                        {"effort[name=shoulder]", "effort[name=elbow]"}}}};
  }
  experiment::RobotView view{.topics = {{"/scan", "sensor_msgs/LaserScan"},
                                        {"/odom", "nav_msgs/Odometry"},
                                        {"/imu", "sensor_msgs/Imu"},
                                        {"/joint_states", "sensor_msgs/JointState"},
                                        {"/tf", "tf2_msgs/TFMessage"},
                                        {"/cmd_vel", "geometry_msgs/Twist", {"linear.x"}}}};
  if (robot.camera) {
    view.topics.push_back({"/camera/image_raw", "sensor_msgs/Image"});
    view.topics.push_back({"/camera/camera_info", "sensor_msgs/CameraInfo"});
  }
  return view;
}

/// As `spikeloop check` reads it. `types` must outlive the result.
inline Read read(const Files& files, const experiment::NodeTypes& types,
                 const experiment::Overrides& overrides = {}) {
  Read result;
  Diagnostics faults;
  try {
    const ExperimentFile file = read_experiment_file(
        files.path(),
        [&](const ConfigurationError& error) { faults.push_back(diagnostic_of(error)); },
        overrides.settings);
    result.experiment = experiment::resolve(file, types, overrides, faults, view_of);
  } catch (const Error& error) {
    faults.push_back(diagnostic_of(error));
  }
  for (const Diagnostic& fault : faults) {
    result.faults.push_back(files.plain(fault.text()));
  }
  return result;
}

/// The value of a section's key; "none" when it has none.
inline std::string key(const MusicFile& file, const char* section, const char* name) {
  const MusicKey* found = file.find_key(file.section(section), name);
  return found == nullptr ? "none" : found->value;
}

}  // namespace spikeloop::test
