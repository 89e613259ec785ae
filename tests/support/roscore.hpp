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

#include "tests/support/child.hpp"

namespace spikeloop::test {

/// A TCP port of this machine that nobody listened on a moment ago.
inline int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  const bool good = ::bind(socket, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                    ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  ::close(socket);
  if (!good) {
    throw std::runtime_error("no free port");
  }
  return ntohs(address.sin_port);
}

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
    for (int attempt = 0; attempt < 5; ++attempt) {
      port_ = free_port();
      Command command;
      command.arguments = {"rosmaster", "--core", "-p", std::to_string(port_)};
      command.timeout = std::chrono::minutes(10);
      command.environment = {
          {"ROS_MASTER_URI", uri()}, {"ROS_HOSTNAME", "localhost"}, {"PYTHONUNBUFFERED", "1"}};
      child_ = std::make_unique<Child>(command);
      // It may be somebody else's that answers there: then ours ends at once, and says so.
      if (answers() && !child_->wait_for("already in use", std::chrono::milliseconds(100))) {
        return;
      }
    }
    throw std::runtime_error("rosmaster does not answer:\n" + child_->output());
  }

  std::string uri() const { return "http://localhost:" + std::to_string(port_); }
  void signal(int number) const { child_->signal(number); }

 private:
  bool answers() {
    for (int i = 0; i < 600; ++i) {
      const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(port_));
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      const bool good =
          ::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
      ::close(socket);
      if (good) {
        return true;
      }
      if (child_->output().find("already in use") != std::string::npos) {
        return false;  // somebody was faster
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }

  int port_ = 0;
  std::unique_ptr<Child> child_;
};

}  // namespace spikeloop::test
