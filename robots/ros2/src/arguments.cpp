#include "spikeloop/ros2/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"

namespace spikeloop::ros2 {
namespace {

constexpr std::string_view kBegin = "--ros-args";
constexpr std::string_view kEnd = "--";
constexpr std::array<std::string_view, 2> kRemap{"-r", "--remap"};
/// What has a value of its own, and we have no use for.
constexpr std::array<std::string_view, 7> kUnused{
    "-p", "--param", "--params-file", "--log-level", "-e", "--enclave", "--log-config-file"};
constexpr std::array<std::string_view, 6> kFlags{
    "--enable-rosout-logs",  "--disable-rosout-logs",      "--enable-stdout-logs",
    "--disable-stdout-logs", "--enable-external-lib-logs", "--disable-external-lib-logs"};

template <typename Names>
bool is_one_of(const Names& names, std::string_view argument) {
  return std::find(names.begin(), names.end(), argument) != names.end();
}

void keep_rule(Remappings& rules, const std::string& text) {
  const auto place = text.find(":=");
  if (place == std::string::npos || place == 0 || place + 2 == text.size()) {
    throw ConfigurationError(
        fmt::format("-r is followed by '{}'; write FROM:=TO, as in -r scan:=/front/scan", text));
  }
  rules[text.substr(0, place)] = text.substr(place + 2);
}

/// What stands after --ros-args.
class RosPart {
 public:
  RosPart(const std::vector<std::string>& arguments, Remappings& rules)
      : arguments_(arguments), rules_(rules) {}

  /// @return the place after what has been read
  std::size_t read(std::size_t place) {
    const std::string& argument = arguments_[place];
    if (is_one_of(kRemap, argument)) {
      keep_rule(rules_, value(place));
      return place + 2;
    }
    if (is_one_of(kUnused, argument)) {
      log::info(
          "'{} {}' has no meaning here: Spikeloop has no ROS parameters, and a log of its own",
          argument, value(place));
      return place + 2;
    }
    if (is_one_of(kFlags, argument)) {
      return place + 1;
    }
    throw ConfigurationError(fmt::format(
        "'{}' after --ros-args is no argument of ROS 2's; write -r FROM:=TO, or end them by --",
        argument));
  }

 private:
  const std::string& value(std::size_t place) const {
    if (place + 1 == arguments_.size()) {
      throw ConfigurationError(fmt::format(
          "'{}' after --ros-args is the last word; write its value", arguments_[place]));
    }
    return arguments_[place + 1];
  }

  const std::vector<std::string>& arguments_;
  Remappings& rules_;
};

}  // namespace

CommandLine split_command_line(int argc, const char* const* argv) {
  const std::vector<std::string> arguments(argv, argv + argc);
  CommandLine line;
  RosPart ros(arguments, line.ros);
  bool within = false;
  for (std::size_t place = 0; place < arguments.size();) {
    const std::string& argument = arguments[place];
    if (argument == kBegin || (within && argument == kEnd)) {
      within = argument == kBegin;
      ++place;
    } else if (within) {
      place = ros.read(place);
    } else if (argument.find(":=") != std::string::npos) {
      keep_rule(line.ros, argument);
      ++place;
    } else {
      line.own.push_back(argument);
      ++place;
    }
  }
  return line;
}

}  // namespace spikeloop::ros2
