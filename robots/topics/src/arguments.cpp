#include "spikeloop/topics/arguments.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::topics {
namespace {

constexpr const char* kNamespace = "__ns";
constexpr const char* kNodeName = "__name";

/// Arguments that begin with '-' are no names: the value of an option may contain ":=", as in
/// --robot-arg=/scan:=/front/scan.
bool add_name(const std::string& argument, RosArguments& names) {
  const auto place = argument.find(":=");
  if (place == std::string::npos || place == 0 || argument.front() == '-') {
    return false;
  }
  const std::string name = argument.substr(0, place);
  names[name == "__node" ? kNodeName : name] = argument.substr(place + 2);
  return true;
}

/// Parser of the arguments after --ros-args: options, each followed by its values.
class Ros2Arguments {
 public:
  explicit Ros2Arguments(CommandLine& line) : line_(line) {}

  void take(const std::string& argument) {
    if (std::exchange(remap_, false)) {
      if (!add_name(argument, line_.ros)) {
        refuse_remap(argument);
      }
    } else if (argument == "-r" || argument == "--remap") {
      remap_ = true;
      foreign_ = false;
    } else if (argument.starts_with('-') || !foreign_) {
      line_.foreign.push_back(argument);
      foreign_ = true;
    } else {
      line_.foreign.back() += " " + argument;
    }
  }
  void end() const {
    if (remap_) {
      refuse_remap("");
    }
  }

 private:
  [[noreturn]] static void refuse_remap(const std::string& argument) {
    throw ConfigurationError(
        with_code(Code::ros_setting,
                  "'-r{}{}' (behind --ros-args) gives no name; write -r NAME:=VALUE, as in -r "
                  "/scan:=/front/scan",
                  argument.empty() ? "" : " ", argument));
  }

  CommandLine& line_;
  bool remap_ = false;    ///< the next word is a rule
  bool foreign_ = false;  ///< a value belongs to the ignored option before it
};

std::optional<bool> truth_of(std::string_view text) {
  return text == "true"    ? std::optional(true)
         : text == "false" ? std::optional(false)
                           : std::nullopt;
}

/// Value in a parameter file for any node, as launch files write it. nullopt if the file has other
/// parameters.
std::optional<bool> use_sim_time_in_file(const std::string& path) {
  constexpr std::string_view kParameter = "use_sim_time:";
  std::ifstream file(path);
  std::optional<bool> found;
  for (std::string name, value; file >> name;) {
    if (name == kParameter && file >> value && truth_of(value)) {
      found = truth_of(value);
    } else if (name != "/**:" && name != "ros__parameters:") {
      return std::nullopt;
    }
  }
  return found;
}

/// Value of "-p use_sim_time:=true" or of a parameter file; nullopt for other arguments.
std::optional<bool> use_sim_time_of(const std::string& foreign) {
  std::istringstream words(foreign);
  std::string option;
  std::string value;
  std::string more;
  words >> option >> value;
  if (words >> more) {
    return std::nullopt;
  }
  constexpr std::string_view kParameter = "use_sim_time:=";
  if ((option == "-p" || option == "--param") && value.starts_with(kParameter)) {
    return truth_of(value.substr(kParameter.size()));
  }
  return option == "--params-file" ? use_sim_time_in_file(value) : std::nullopt;
}

/// Topic of a rule. In ROS 2 a rule may begin with the name of the node to which it applies.
std::string topic_of_rule(messages::Dialect ros, const std::string& name) {
  const auto colon = ros == messages::Dialect::ros2 ? name.find(':') : std::string::npos;
  return colon == std::string::npos ? name : name.substr(colon + 1);
}

void check_argument(messages::Dialect ros, const std::string& name, const std::string& value) {
  if (name == kNodeName) {
    check_node_name(ros, value);
  } else if (name == kNamespace) {
    check_topic(ros, value.starts_with('/') ? value : "/" + value);
  } else if (name.starts_with('_')) {
    throw ConfigurationError(
        with_code(Code::ros_setting,
                  "'{}:={}' means nothing here: topics have other names by NAME:=VALUE, as "
                  "/scan:=/front/scan, and the node by __ns and __name; leave it out",
                  name, value));
  } else {
    check_topic(ros, topic_of_rule(ros, name));
    check_topic(ros, value);
  }
}

}  // namespace

CommandLine split_command_line(int argc, const char* const* argv) {
  CommandLine line;
  Ros2Arguments ros2(line);
  bool of_ros2 = false;
  for (int i = 0; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--ros-args") {
      of_ros2 = true;
    } else if (of_ros2 && argument == "--") {
      of_ros2 = false;
    } else if (of_ros2) {
      ros2.take(argument);
    } else if (!add_name(argument, line.ros)) {
      line.own.push_back(argument);
    }
  }
  ros2.end();
  std::erase_if(line.foreign, [&](const std::string& argument) {
    const std::optional<bool> value = use_sim_time_of(argument);
    line.use_sim_time = value ? value : line.use_sim_time;
    return value.has_value();
  });
  return line;
}

std::string to_text(const RosArguments& arguments) {
  std::string text;
  for (const auto& [name, value] : arguments) {
    text += fmt::format("{}{}:={}", text.empty() ? "" : " ", name, value);
  }
  return text;
}

RosArguments read_ros_arguments(const std::string& text) {
  RosArguments arguments;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!add_name(word, arguments)) {
      throw ConfigurationError(with_code(
          Code::ros_setting,
          "'{}' is not an argument of ROS; write NAME:=VALUE, as in /scan:=/front/scan", word));
    }
  }
  return arguments;
}

void check_ros_arguments(messages::Dialect ros, const RosArguments& arguments) {
  for (const auto& [name, value] : arguments) {
    check_argument(ros, name, value);
  }
}

std::string renamed(const std::string& whole_topic, const RosArguments& arguments) {
  const auto space = arguments.find(kNamespace);
  const auto whole = [&](const std::string& name) {
    if (name.starts_with('/')) {
      return name;
    }
    const std::string in = space == arguments.end() ? "" : space->second;
    return fmt::format("{}{}/{}", in.empty() || in.starts_with('/') ? "" : "/", in == "/" ? "" : in,
                       name);
  };
  for (const auto& [name, value] : arguments) {
    if (!name.starts_with('_') && whole(name) == whole_topic) {
      return whole(value);
    }
  }
  return whole_topic;
}

}  // namespace spikeloop::topics
