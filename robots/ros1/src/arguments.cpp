#include "spikeloop/ros1/arguments.hpp"

namespace spikeloop::ros1 {

CommandLine split_command_line(int argc, const char* const* argv) {
  CommandLine line;
  for (int i = 0; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto place = argument.find(":=");
    if (place == std::string::npos) {
      line.own.push_back(argument);
    } else {
      line.ros[argument.substr(0, place)] = argument.substr(place + 2);
    }
  }
  return line;
}

}  // namespace spikeloop::ros1
