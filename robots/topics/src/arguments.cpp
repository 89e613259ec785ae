#include "spikeloop/topics/arguments.hpp"

#include <string_view>

namespace spikeloop::topics {
namespace {

bool add_name(const std::string& argument, RosArguments& names) {
  const auto place = argument.find(":=");
  if (place == std::string::npos) {
    return false;
  }
  const std::string name = argument.substr(0, place);
  names[name == "__node" ? "__name" : name] = argument.substr(place + 2);
  return true;
}

}  // namespace

CommandLine split_command_line(int argc, const char* const* argv) {
  CommandLine line;
  bool of_ros2 = false;
  std::string_view before;
  for (int i = 0; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--ros-args") {
      of_ros2 = true;
    } else if (of_ros2 && argument == "--") {
      of_ros2 = false;
    } else if (of_ros2) {
      if (before == "-r" || before == "--remap") {
        add_name(argument, line.ros);
      }
    } else if (!add_name(argument, line.ros)) {
      line.own.push_back(argument);
    }
    before = argv[i];
  }
  return line;
}

}  // namespace spikeloop::topics
