#include "spikeloop/zmq/address.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <net/if.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <string_view>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::zmq {
namespace {

constexpr std::string_view kFile = "ipc://";
constexpr std::string_view kNetwork = "tcp://";

[[noreturn]] void refuse(const std::string& address, const std::string& reason) {
  throw ConfigurationError(with_code(Code::invalid_topic, "zmq_addr '{}' {}", address, reason));
}

void check_path(const std::string& address) {
  const std::size_t size = address.size() - kFile.size();
  constexpr std::size_t kMost = sizeof(sockaddr_un::sun_path) - 1;
  if (size > kMost) {
    refuse(address, fmt::format("has a path of {} bytes; write one of at most {}", size, kMost));
  }
}

void check_address(const std::string& address) {
  if (address.starts_with(kFile) && address.size() > kFile.size()) {
    check_path(address);
    return;
  }
  constexpr const char* kRemedy =
      "is not an address; write tcp://HOST:PORT, or tcp://*:PORT to publish on every interface";
  const auto colon = address.rfind(':');
  if (!address.starts_with(kNetwork) || colon <= kNetwork.size()) {
    refuse(address, kRemedy);
  }
  // ZeroMQ takes port 99999 for 34463.
  const std::string port = address.substr(colon + 1);
  const bool digits = !port.empty() && port.find_first_not_of("0123456789") == std::string::npos;
  if (port != "*" && (!digits || port.size() > 5 || std::stoi(port) > 65535)) {
    refuse(address, kRemedy);
  }
}

/// Of a tcp address; else empty.
std::string host_of(const std::string& address) {
  return address.starts_with(kNetwork)
             ? address.substr(kNetwork.size(), address.rfind(':') - kNetwork.size())
             : "";
}

}  // namespace

void check_connect_address(const std::string& address) {
  check_address(address);
  if (host_of(address) == "*") {
    refuse(address, "names no host to connect to; write it, as in tcp://localhost:5555");
  }
}

void check_bind_address(const std::string& address) {
  check_address(address);
  struct stat file {};
  if (address.starts_with(kFile) && ::stat(address.c_str() + kFile.size(), &file) == 0 &&
      !S_ISSOCK(file.st_mode)) {
    refuse(address, "is the path of something else than a socket; write another one");
  }
  const std::string host = host_of(address);
  in_addr ignored{};
  if (!host.empty() && host != "*" && ::inet_pton(AF_INET, host.c_str(), &ignored) != 1 &&
      ::if_nametoindex(host.c_str()) == 0) {
    refuse(address,
           "is not an address to publish at; write an IP address of this machine, as in "
           "tcp://127.0.0.1:5556, or tcp://*:5556 to publish on every interface");
  }
}

}  // namespace spikeloop::zmq
