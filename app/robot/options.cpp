#include "options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "spikeloop/core/error.hpp"

namespace spikeloop::robot {
namespace {

constexpr const char* kDescription =
    "A skid-steered vehicle in a simulated world (MuJoCo), as a node of ROS 1 or 2. Publishes\n"
    "laser scans (20 Hz), odometry, joint states, /tf (50 Hz), inertial data (100 Hz), light in a\n"
    "world with lamps (50 Hz), pictures when asked to, and the clock, all in simulated time; "
    "drives as\n"
    "geometry_msgs/Twist says (linear.x, angular.z). docs/robot.md has topics, frames and worlds.";

constexpr const char* kExamples =
    "Examples:\n"
    "  spikeloop-robot                               the shipped arena, seed 1, until Ctrl-C\n"
    "  spikeloop-robot --seed 3 --duration 60 --out run    one minute, path and world in run/\n"
    "  spikeloop-robot --world lab.xml --real-time-factor 0.5    your world at half speed\n"
    "  spikeloop-robot --world phototaxis --camera 64x48    a lamp to see, and a camera\n"
    "  spikeloop-robot --duration 20 --render drive.mp4 --render-view above+chase\n"
    "  spikeloop-robot --step                        moves when an experiment with sync: lockstep "
    "says so\n"
    "  rostopic pub -r 10 /cmd_vel geometry_msgs/Twist '{linear: {x: 0.3}, angular: {z: 0.5}}'\n"
    "\n"
    "Exit codes: 0 done or stopped, 2 wrong option or world, 3 no ROS master, 4 a file could not\n"
    "be read or written, 5 the simulation failed.";

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
      app.add_option("--camera", words.camera, "camera/image_raw: pictures of WIDTHxHEIGHT pixels");
  app.add_option("--camera-rate", words.seen.rate_hz, "pictures in a simulated second")
      ->check(within(0.001, 1000.0))
      ->capture_default_str()
      ->needs(camera);
  app.add_option("--camera-fov", words.seen.field_of_view_deg,
                 "degrees from the left edge to the right one")
      ->check(within(1.0, 170.0))
      ->capture_default_str()
      ->needs(camera);
  auto* render = app.add_option(
      "--render", words.spectators.render,
      "a film: FILE.mp4 (.webm, .mkv, .gif; needs ffmpeg), a directory of pictures, or FILE.png: "
      "the end, with the path driven");
  app.add_option("--render-view", words.spectators.view,
                 "above, chase, camera, or several: above+chase")
      ->capture_default_str()
      ->needs(render);
  app.add_option("--render-size", words.spectators.size, "WIDTHxHEIGHT in pixels")
      ->capture_default_str()
      ->needs(render);
  app.add_option("--render-rate", words.spectators.rate_hz, "pictures in a simulated second")
      ->check(within(0.001, 1000.0))
      ->capture_default_str()
      ->needs(render);
  app.add_flag("--view", words.spectators.window, "a window on the world; needs a display");
}

void declare(CLI::App& app, RunOptions& options) {
  app.set_version_flag("--version", std::string("spikeloop-robot ") + SPIKELOOP_VERSION);
  app.footer(kExamples);
  app.add_option("--world", options.vehicle.world, "MJCF file, or the name of a shipped one")
      ->capture_default_str();
  app.add_option("--seed", options.vehicle.seed, "places the obstacles and the start pose")
      ->capture_default_str();
  auto* duration =
      app.add_option("--duration", options.duration_s, "simulated seconds; 0: until stopped")
          ->check(within(0.0, 1e9))
          ->capture_default_str();
  app.add_option("--real-time-factor", options.real_time_factor,
                 "simulated seconds in a second of the wall clock")
      ->check(within(1e-3, 1e3))
      ->capture_default_str();
  app.add_option("--clock-rate", options.clock_rate_hz,
                 "how often /clock is published, Hz of simulated time")
      ->check(within(1.0, 1000.0))
      ->capture_default_str();
  app.add_flag("--step", options.step,
               "waits for nothing but an experiment that steps it (sync: lockstep)")
      ->excludes(duration);
  app.add_option("--out", options.out, "directory for trajectory.csv and world.json");
  app.add_option("--topic-prefix", options.topic_prefix, "before topics without a leading '/'")
      ->capture_default_str();
  app.add_option("--scan-topic", options.scan_topic, "sensor_msgs/LaserScan out")
      ->capture_default_str();
  app.add_option("--odom-topic", options.odometry_topic, "nav_msgs/Odometry out")
      ->capture_default_str();
  app.add_option("--clock-topic", options.clock_topic, "rosgraph_msgs/Clock out")
      ->capture_default_str();
  app.add_option("--cmd-topic", options.command_topic, "geometry_msgs/Twist in")
      ->capture_default_str();
  app.add_option("--ros", options.ros, "version of ROS")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  app.add_option("--node-name", options.node_name, "name of the ROS node")->capture_default_str();
  app.add_option("--master-timeout", options.master_timeout_s,
                 "seconds to wait for the master of ROS 1")
      ->check(within(0.0, 1e6))
      ->capture_default_str();
}

}  // namespace

std::string RunOptions::topic(const std::string& name) const {
  if (name.starts_with('/')) return name;
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
  declare(app, options);
  declare_pictures(app, words);
  try {
    app.parse(argc, argv);
    take(words, options);
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
