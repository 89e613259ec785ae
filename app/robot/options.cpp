#include "options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "spikeloop/core/error.hpp"

namespace spikeloop::robot {
namespace {

constexpr const char* kDescription =
    "Simulates a skid-steered vehicle (MuJoCo) as a node of ROS 1 or 2. Publishes laser scans\n"
    "(20 Hz), odometry, joint states, /tf (50 Hz), inertial data (100 Hz), light in a world with\n"
    "lamps and the place on a lane (50 Hz), optional camera images, and the clock, all in "
    "simulated\n"
    "time. Follows geometry_msgs/Twist (linear.x, angular.z). Topics, frames and worlds: "
    "docs/robot.md.";

constexpr const char* kExamples =
    "Examples:\n"
    "  spikeloop-robot                               the shipped arena, seed 1, until Ctrl-C\n"
    "  spikeloop-robot --seed 3 --duration 60 --out run    one minute, path and world in run/\n"
    "  spikeloop-robot --world lab.xml --real-time-factor 0.5    a custom world at half speed\n"
    "  spikeloop-robot --world phototaxis --camera 64x48    a world with a lamp; a camera\n"
    "  spikeloop-robot --duration 20 --render drive.mp4 --render-view above+chase\n"
    "  spikeloop-robot --model arm.xml --keyframe home --ros 2    any robot in MJCF\n"
    "  spikeloop-robot --step                        stepped by an experiment with sync: lockstep\n"
    "  rostopic pub -r 10 /cmd_vel geometry_msgs/Twist '{linear: {x: 0.3}, angular: {z: 0.5}}'\n"
    "\n"
    "Exit codes: 0 finished or stopped, 2 invalid option or world, 3 no ROS master, 4 a file\n"
    "cannot be read or written, 5 the simulation failed.";

/// CLI::Range takes NaN for a number between any two.
CLI::Validator within(double least, double most) {
  return {[least, most](std::string& text) {
            double value = 0;
            const bool fits =
                CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return fits ? std::string()
                        : fmt::format("Value {} not in range {:f} to {:f}", text, least, most);
          },
          fmt::format("FLOAT in [{} - {}]", least, most)};
}

/// Options that mean something together.
struct PictureWords {
  std::string camera;
  pictures::CameraOptions seen;
  SpectatorWords spectators;
};

void take(const PictureWords& words, RunOptions& options) {
  if (!words.camera.empty()) {
    options.camera = words.seen;
    options.camera->size = pictures::size_named(words.camera);
  }
  options.spectators = words.spectators.options();
}

void declare_pictures(CLI::App& app, PictureWords& words) {
  auto* camera =
      app.add_option("--camera", words.camera, "WIDTHxHEIGHT of the images on camera/image_raw");
  app.add_option("--camera-name", words.seen.name, "Name of the camera in the MJCF file")
      ->capture_default_str()
      ->needs(camera);
  app.add_option("--camera-rate", words.seen.rate_hz, "Images per simulated second")
      ->check(within(0.001, 1000.0))
      ->capture_default_str()
      ->needs(camera);
  app.add_option("--camera-fov", words.seen.field_of_view_deg, "Horizontal field of view, degrees")
      ->check(within(1.0, 170.0))
      ->capture_default_str()
      ->needs(camera);
  auto* render = app.add_option(
      "--render", words.spectators.render,
      "Film of the robot, FILE.mp4 (.webm, .mkv, .gif; needs ffmpeg); folder of images; or "
      "FILE.png, the final state with the path");
  app.add_option("--render-view", words.spectators.view,
                 "above, chase, camera, or several: above+chase")
      ->capture_default_str()
      ->needs(render);
  app.add_option("--render-size", words.spectators.size, "WIDTHxHEIGHT in pixels")
      ->capture_default_str()
      ->needs(render);
  app.add_option("--render-rate", words.spectators.rate_hz, "Images per simulated second")
      ->check(within(0.001, 1000.0))
      ->capture_default_str()
      ->needs(render);
  app.add_flag("--view", words.spectators.window, "Show the robot in a window; needs a display");
}

/// Of another robot than the vehicle.
struct ModelWords {
  std::string file;
  std::string keyframe;
};

void declare_model(CLI::App& app, ModelWords& words, RunOptions& options) {
  auto* model = app.add_option("--model", words.file,
                               "MJCF file of another robot, which takes sensor_msgs/JointState on "
                               "joint_commands")
                    ->excludes("--world");
  app.add_option("--keyframe", words.keyframe, "Keyframe of the model to start from")->needs(model);
  app.add_option("--model-rate", options.model_rate_hz,
                 "Rate of the model's joint states and sensors, Hz")
      ->check(within(0.001, 1000.0))
      ->capture_default_str()
      ->needs(model);
}

void declare(CLI::App& app, RunOptions& options, ModelWords& model) {
  app.set_version_flag("--version", std::string("spikeloop-robot ") + SPIKELOOP_VERSION);
  app.footer(kExamples);
  app.add_option("--world", options.vehicle.world, "MJCF file, or name of a shipped world")
      ->capture_default_str();
  app.add_option("--seed", options.vehicle.seed, "Seed of obstacles and start pose")
      ->capture_default_str();
  declare_model(app, model, options);
  auto* duration =
      app.add_option("--duration", options.duration_s, "Simulated time, s; 0: until stopped")
          ->check(within(0.0, 1e9))
          ->capture_default_str();
  app.add_option("--real-time-factor", options.real_time_factor,
                 "Ratio of simulated time to wall time")
      ->check(within(1e-3, 1e3))
      ->capture_default_str();
  app.add_option("--clock-rate", options.clock_rate_hz, "Rate of /clock in simulated time, Hz")
      ->check(within(1.0, 1000.0))
      ->capture_default_str();
  app.add_flag("--step", options.step,
               "Advance only when an experiment steps the robot (sync: lockstep)")
      ->excludes(duration);
  app.add_option("--out", options.out, "Folder for trajectory.csv and world.json");
  app.add_option_function<std::string>(
         "--on-write-failure",
         [&options](const std::string& choice) {
           options.on_write_failure = on_write_failure_of(choice);
         },
         "If a file in --out cannot be written: stop (default) or continue")
      ->check(CLI::IsMember(on_write_failure_choices()));
  app.add_option("--topic-prefix", options.topic_prefix,
                 "Prefix of topics without leading '/'; default: the node's namespace");
  app.add_option("--scan-topic", options.scan_topic, "Output topic, sensor_msgs/LaserScan")
      ->capture_default_str();
  app.add_option("--odom-topic", options.odometry_topic, "Output topic, nav_msgs/Odometry")
      ->capture_default_str();
  app.add_option("--clock-topic", options.clock_topic, "Output topic, rosgraph_msgs/Clock")
      ->capture_default_str();
  app.add_option("--cmd-topic", options.command_topic,
                 "Input topic; default: cmd_vel, or joint_commands of a model");
  app.add_option("--ros", options.ros, "ROS version")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  app.add_option("--node-name", options.node_name, "Name of the ROS node")->capture_default_str();
  app.add_option("--master-timeout", options.master_timeout_s,
                 "Time to wait for the ROS 1 master, s")
      ->check(within(0.0, 1e6))
      ->capture_default_str();
}

}  // namespace

std::string RunOptions::topic(const std::string& name) const {
  if (name.starts_with('/') || topic_prefix.empty()) return name;
  return topic_prefix.ends_with('/') ? topic_prefix + name : topic_prefix + "/" + name;
}

std::string RunOptions::sensor_topic(const std::string& name) const {
  if (name == "scan") return topic(scan_topic);
  return topic(name == "odom" ? odometry_topic : name);
}

std::optional<RunOptions> parse_options(int argc, char** argv, int& exit_code) {
  RunOptions options;
  CLI::App app(kDescription, "spikeloop-robot");
  PictureWords words;
  ModelWords model;
  declare(app, options, model);
  declare_pictures(app, words);
  try {
    app.parse(argc, argv);
    take(words, options);
    if (!model.file.empty()) options.model = {model.file, model.keyframe};
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  } catch (const ConfigurationError& error) {
    fmt::print(stderr, "spikeloop-robot: {}\n", error.what());
    exit_code = 2;
    return std::nullopt;
  }
  return options;
}

}  // namespace spikeloop::robot
