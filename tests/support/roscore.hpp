// A ROS 1 master of the test's own on a free port.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "spikeloop/processes/reserved_port.hpp"
#include "tests/support/child.hpp"

namespace spikeloop::test {

/// Lets everybody connect and answers nobody.
class SilentHost {
 public:
  SilentHost() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    if (::bind(socket_, generic, size) != 0 || ::listen(socket_, 5) != 0 ||
        ::getsockname(socket_, generic, &size) != 0) {
      throw std::runtime_error("cannot listen");
    }
    port_ = ntohs(address.sin_port);
  }
  ~SilentHost() { ::close(socket_); }
  SilentHost(const SilentHost&) = delete;
  SilentHost& operator=(const SilentHost&) = delete;

  std::string uri() const { return "http://127.0.0.1:" + std::to_string(port_); }
  /// Waits until somebody has connected.
  bool connected(std::chrono::milliseconds limit) const {
    pollfd waiting{socket_, POLLIN, 0};
    return ::poll(&waiting, 1, static_cast<int>(limit.count())) == 1;
  }
  /// Waits for the next connection; the caller closes it. -1 after stop().
  int accept() const { return ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC); }
  void stop() const { ::shutdown(socket_, SHUT_RDWR); }

 private:
  int socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  std::uint16_t port_ = 0;
};

/// The master that roscore starts, without roscore's logging node. Ends with the object.
class RosCore {
 public:
  RosCore() {
    Command command;
    command.arguments = {"rosmaster", "--core", "-p", port_.text()};
    command.timeout = std::chrono::minutes(10);
    command.environment = {
        {"ROS_MASTER_URI", uri()}, {"ROS_HOSTNAME", "localhost"}, {"PYTHONUNBUFFERED", "1"}};
    child_ = std::make_unique<Child>(command);
    if (!answers()) {
      throw std::runtime_error("rosmaster does not answer:\n" + child_->output());
    }
  }

  std::string uri() const { return "http://localhost:" + port_.text(); }
  void signal(int number) const { child_->signal(number); }

 private:
  bool answers() {
    for (int i = 0; i < 600; ++i) {
      const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(port_.number()));
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      const bool good =
          ::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
      ::close(socket);
      if (good) {
        return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }

  ReservedPort port_;
  std::unique_ptr<Child> child_;
};

}  // namespace spikeloop::test
