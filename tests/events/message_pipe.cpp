// Publishes the messages that come in on standard input, a line of hexadecimal digits each, until
// its end: a camera whose bytes a test makes.
//
//     message_pipe ROS TOPIC TYPE
#include <fmt/format.h>

#include <iostream>
#include <string>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/session/open.hpp"
#include "spikeloop/topics/arguments.hpp"

namespace {

std::vector<std::byte> bytes_of(const std::string& digits) {
  std::vector<std::byte> bytes;
  for (std::size_t at = 0; at + 1 < digits.size(); at += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoi(digits.substr(at, 2), nullptr, 16)));
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace spikeloop;
  if (argc != 4) {
    fmt::print(stderr, "write message_pipe ROS TOPIC TYPE\n");
    return 2;
  }
  const auto ros = std::string(argv[1]) == "2" ? messages::Dialect::ros2 : messages::Dialect::ros1;
  try {
    const auto session = session::open({{.node_name = "camera", .unique_name = true}, ros});
    const auto publisher = session->publisher(argv[2], argv[3], 1000);
    for (std::string line; std::getline(std::cin, line);) {
      publisher->publish(bytes_of(line));
    }
    publisher->drain();
  } catch (const Error& error) {
    fmt::print(stderr, "message_pipe: {}\n", error.what());
    return 1;
  }
  return 0;
}
