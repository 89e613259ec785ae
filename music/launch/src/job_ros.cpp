// The part of a run that has to do with ROS: a master, a robot.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cctype>
#include <thread>

#include "external_topics.hpp"
#include "job_run.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/write_failures.hpp"
#include "spikeloop/launch/effective_file.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/launch/ros_master.hpp"

namespace spikeloop::launch {
namespace {

constexpr Milliseconds kRosStart{30'000};
constexpr Milliseconds kHelperGrace{3'000};

std::string last_line(const Process& process) {
  return process.error_tail().empty() ? "" : "; its last line: " + process.error_tail();
}

/// What a rosmaster that does not answer said, and what to do when `master` has no address.
std::string rosmaster_trouble(const Process& rosmaster, const RosMaster& master) {
  std::string text;
  if (!rosmaster.error_tail().empty()) {
    text = "; it says: " + rosmaster.error_tail();
  }
  if (const std::string unresolved = master.unresolved(); !unresolved.empty()) {
    text += "; " + unresolved;
  }
  return text;
}

/// The robot keeps the seed and the real-time factor of the sensor adapter, or of the first
/// program, unless it was given others.
void add_robot_option(const MusicFile& file, const char* key, const char* option,
                      const std::vector<std::string>& given, std::vector<std::string>& arguments) {
  const auto source = std::find_if(file.sections.begin(), file.sections.end(),
                                   [&file](const MusicSection& section) {
                                     const Program* program = find_program(file, section);
                                     return program != nullptr && program->source;
                                   });
  const MusicKey* found =
      file.find_key(source == file.sections.end() ? file.sections.front() : *source, key);
  const auto begins = [option](const std::string& argument) {
    return argument.starts_with(option);
  };
  if (found != nullptr && std::none_of(given.begin(), given.end(), begins)) {
    arguments.insert(arguments.end(), {option, found->value});
  }
}

/// Of  --scan-topic=/front  or  --scan-topic /front;  empty when it is not given.
std::string option_of(const std::vector<std::string>& arguments, const std::string& option) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i].starts_with(option + "=")) {
      return arguments[i].substr(option.size() + 1);
    }
    if (arguments[i] == option && i + 1 < arguments.size()) {
      return arguments[i + 1];
    }
  }
  return "";
}

/// The topic of spikeloop-robot that such an option names; the prefix is for relative names.
std::string robot_topic(const std::vector<std::string>& arguments, const std::string& option,
                        const std::string& otherwise) {
  const std::string given = option_of(arguments, option);
  if (given.starts_with('/')) {
    return topic_name(given);
  }
  return topic_name(option_of(arguments, "--topic-prefix") + "/" +
                    (given.empty() ? otherwise : given));
}

bool takes_scans(const MusicFile& file, const MusicSection& section) {
  const MusicKey* type = file.find_key(section, "message_type");
  std::string name = type == nullptr ? "" : type->value;
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.ends_with("laserscan");
}

/// A robot whose scans no program takes, or whose commands no program sends.
void warn_of_other_topics(const MusicFile& file, bool sources, const std::string& topic,
                          const char* option) {
  const MusicSection* other = nullptr;
  std::string others;
  for (const MusicSection* section : in_written_order(file)) {
    const Program* program = find_program(file, *section);
    if (program == nullptr || !program->ros || program->source != sources ||
        (sources && !takes_scans(file, *section))) {
      continue;
    }
    const std::string name = topic_name(written_place(file, *section, *program));
    if (name == topic) {
      return;
    }
    if (other == nullptr) {
      other = section;
      others = name;
    }
  }
  if (other != nullptr) {
    log::warning("the robot {} {}, and '{}' {} {}: write  --robot-arg={}={}",
                 sources ? "sends" : "takes", topic, other->label, sources ? "takes" : "sends",
                 others, option, others);
  }
}

/// A robot that was killed has not said goodbye to its master.
std::vector<std::string> living(const RosMaster& master, const std::string& topic) {
  std::vector<std::string> nodes = master.publishers(topic);
  std::erase_if(nodes, [&master](const std::string& node) { return !master.is_alive(node); });
  return nodes;
}

}  // namespace

bool JobRun::start_ros() {
  const bool master =
      needs_ros(effective_.file, 1) || options_.roscore || (options_.robot && robot_ros() == 1);
  return (!master || find_master()) && (!options_.robot || start_robot());
}

int JobRun::robot_ros() const {
  const bool ros2 = needs_ros(effective_.file, 2) && !needs_ros(effective_.file, 1);
  return ros2 ? 2 : 1;
}

/// In a file of its own format, from which this one was made.
bool JobRun::is_experiment() const {
  return options_.translate != nullptr;
}

bool JobRun::find_master() {
  const RosMaster master(master_uri());
  ros_environment_["ROS_MASTER_URI"] = master.uri();
  ros_environment_["ROS_LOG_DIR"] = folder_ + "/ros";
  if (!master.answers()) {
    if (stopped_already()) {
      return false;  // while it was asked
    }
    if (!options_.roscore) {
      if (const std::string unresolved = master.unresolved(); !unresolved.empty()) {
        throw TransportError(
            with_code(Code::no_ros_master,
                      "no ROS master answers at {}: {}, or write another address into "
                      "ROS_MASTER_URI",
                      master.uri(), unresolved));
      }
      throw TransportError(with_code(
          Code::no_ros_master,
          "no ROS master answers at {}; start one (roscore), write its address into "
          "ROS_MASTER_URI, or {}",
          master.uri(),
          is_experiment() ? "write  robot: {simulator: mujoco}  for a robot and a master of our own"
                          : "let us start one of our own: --roscore"));
    }
    return start_rosmaster();
  }
  return true;
}

bool JobRun::start_rosmaster() {
  // All programs run on this machine, whose name need not be known to any name server.
  ros_environment_["ROS_HOSTNAME"] = "localhost";
  const std::string port = rosmaster_port_.emplace().text();
  const RosMaster master("http://localhost:" + port);
  ros_environment_["ROS_MASTER_URI"] = master.uri();
  ProgramStart start;
  start.arguments = {"rosmaster", "--core", "-p", port};
  rosmaster_ = &group_.start(with_environment(start), [this](const OutputLine& line) {
    log_ << "rosmaster: " << line.text << std::endl;
  });
  const bool in_time = group_.turn_until(
      [&] { return outcome_.has_value() || rosmaster_->gone() || master.answers(); }, kRosStart);
  if (outcome_) {
    return false;
  }
  if (in_time && !rosmaster_->gone()) {
    log::info("ROS master at {}", master.uri());
    return true;
  }
  throw TransportError(with_code(
      Code::no_ros_master, "{}{}",
      rosmaster_->gone()
          ? "rosmaster ended before it answered"
          : fmt::format("rosmaster has not begun to answer within {} s", kRosStart.count() / 1000),
      rosmaster_trouble(*rosmaster_, master)));
}

/// Says so when a master still knows a robot that has gone.
bool JobRun::robot_is_there(const std::string& scan_topic) {
  if (robot_ros() == 2) {
    return options_.published_in_ros2 && options_.published_in_ros2(scan_topic);
  }
  const RosMaster master(ros_environment_["ROS_MASTER_URI"]);
  if (!living(master, scan_topic).empty()) {
    return true;
  }
  for (const std::string& dead : master.publishers(scan_topic)) {
    log::warning(
        "the ROS master has {} as a publisher of {}, but it does not answer: a robot of "
        "our own is started; 'rosnode cleanup' makes the master forget the other one",
        dead, scan_topic);
  }
  return false;
}

bool JobRun::start_robot() {
  const std::string scan_topic =
      robot_topic(options_.robot_arguments, "--scan-topic", options_.scan_topic);
  if (robot_is_there(scan_topic)) {
    log::info("{} is published already: no robot is started", scan_topic);
    return true;
  }
  if (options_.run.ros_arguments.empty() && !is_experiment()) {
    warn_of_other_topics(effective_.file, true, scan_topic, "--scan-topic");
    warn_of_other_topics(effective_.file, false,
                         robot_topic(options_.robot_arguments, "--cmd-topic", "/cmd_vel"),
                         "--cmd-topic");
  }
  ProgramStart start;
  start.arguments = {"spikeloop-robot", "--out", folder_, "--ros", std::to_string(robot_ros())};
  if (option_of(options_.robot_arguments, "--topic-prefix").empty()) {
    // Where the job's topics are, which a namespace does not move.
    start.arguments.emplace_back("--topic-prefix=/");
  }
  add_robot_option(effective_.file, "seed", "--seed", options_.robot_arguments, start.arguments);
  add_robot_option(effective_.file, "rtf", "--real-time-factor", options_.robot_arguments,
                   start.arguments);
  add_robot_option(effective_.file, kOnWriteFailureKey, "--on-write-failure",
                   options_.robot_arguments, start.arguments);
  start.arguments.insert(start.arguments.end(), options_.robot_arguments.begin(),
                         options_.robot_arguments.end());
  robot_ = &group_.start(with_environment(start),
                         [this](const OutputLine& line) { take_line("robot", line); });
  const auto drives = [this] { return state_.has_ticked("robot"); };
  group_.turn_until([&] { return outcome_ || robot_->gone() || drives(); }, kRosStart);
  if (const auto& failure = state_.failure()) {
    fail(failure->exit_code, failure->message);
  } else if (robot_->gone()) {
    const int code = exit_code(robot_->tree().status().value_or(1));
    fail(exit_code_without_robot(code),
         with_code(Code::partner_failed, "robot: ended with exit code {}{}", code,
                   last_line(*robot_)));
  } else if (!outcome_ && !drives()) {
    fail(TransportError::kExitCode,
         with_code(Code::partner_failed, "robot: has not begun within {} s{}",
                   kRosStart.count() / 1000, last_line(*robot_)));
  }
  return !outcome_;
}

int JobRun::exit_code_without_robot(int code) {
  return code == 0 ? TransportError::kExitCode : code;
}

void JobRun::end_helper(Process* helper) {
  if (helper == nullptr || helper->gone()) {
    return;
  }
  helper->tree().signal(SIGINT);
  if (!group_.turn_until([helper] { return helper->gone(); }, kHelperGrace)) {
    helper->tree().end();
    group_.turn_until([helper] { return helper->gone(); }, kHelperGrace);
  }
}

void JobRun::kill_programs() {
  if (mpirun_ == nullptr || mpirun_->tree().gone()) {
    return;
  }
  // Without the group, whose handlers may have caused the error.
  ProcessTree& tree = mpirun_->tree();
  tree.kill();
  const auto deadline = Clock::now() + kHelperGrace;
  while (!tree.gone() && Clock::now() < deadline) {
    std::this_thread::sleep_for(Milliseconds{10});
  }
}

void JobRun::end_helpers() {
  end_guard();  // while there still is a master to say goodbye to
  end_helper(robot_);
  end_helper(rosmaster_);
}

}  // namespace spikeloop::launch
