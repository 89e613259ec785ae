#include "spikeloop/ros1/master.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>
#include <thread>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::ros1 {
namespace {

constexpr TimeNs kRetry = 100'000'000;
/// A single question has so much time, even with a timeout of zero.
constexpr TimeNs kLeastPatience = 500'000'000;
/// The first question may wait so long, each next one twice as long: under load a connection may
/// be lost, and then only a new one helps; but a master that is slow must get its time, too.
constexpr TimeNs kFirstPatience = 1'000'000'000;

bool is_set(const std::atomic<bool>* flag) {
  return flag != nullptr && flag->load();
}

/// One question to the master.
class Probe {
 public:
  Probe(const MasterAddress& address, TimeNs deadline, const std::atomic<bool>* cancelled)
      : deadline_(deadline), cancelled_(cancelled) {
    if (open(address) && send_request(address) && receive_status()) {
      reason_.clear();
    }
  }
  ~Probe() { close_socket(); }
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;

  /// Why there was no answer; empty: there was one.
  const std::string& reason() const { return reason_; }
  /// The reason is that the host has no address.
  bool unresolved() const { return unresolved_; }

 private:
  bool open(const MasterAddress& address) {
    addrinfo hints{};
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* list = nullptr;
    const int error =
        ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &list);
    if (error != 0) {
      unresolved_ = true;
      reason_ = ::gai_strerror(error);
      return false;
    }
    const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(list, ::freeaddrinfo);
    for (const addrinfo* each = list; each != nullptr; each = each->ai_next) {
      if (connect_to(*each)) {
        return true;
      }
      close_socket();
    }
    return false;
  }

  bool connect_to(const addrinfo& address) {
    socket_ = ::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) {
      return fail(errno);
    }
    if (::connect(socket_, address.ai_addr, address.ai_addrlen) == 0) {
      return true;
    }
    if (errno != EINPROGRESS) {
      return fail(errno);
    }
    if (!wait(POLLOUT)) {
      return false;
    }
    int error = 0;
    socklen_t size = sizeof error;
    ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
    return error == 0 || fail(error);
  }

  bool send_request(const MasterAddress& address) {
    const std::string_view body =
        "<?xml version=\"1.0\"?><methodCall><methodName>getPid</methodName><params><param>"
        "<value><string>/spikeloop</string></value></param></params></methodCall>";
    const std::string request = fmt::format(
        "POST / HTTP/1.0\r\nHost: {}:{}\r\nContent-Type: text/xml\r\n"
        "Content-Length: {}\r\n\r\n{}",
        address.host, address.port, body.size(), body);
    // A few hundred bytes fit the empty buffer of a new connection.
    const auto sent = ::send(socket_, request.data(), request.size(), MSG_NOSIGNAL);
    return sent == static_cast<ssize_t>(request.size()) || fail(errno);
  }

  bool receive_status() {
    std::string answer;
    while (answer.find("\r\n") == std::string::npos && answer.size() < 1000) {
      if (!wait(POLLIN)) {
        return false;
      }
      char buffer[256];
      const auto count = ::recv(socket_, buffer, sizeof buffer, 0);
      if (count <= 0) {
        break;
      }
      answer.append(buffer, static_cast<std::size_t>(count));
    }
    if (answer.starts_with("HTTP/") && answer.find(" 200 ") != std::string::npos) {
      return true;
    }
    reason_ = "what answers there is no ROS master";
    return false;
  }

  bool wait(short events) {
    pollfd descriptor{socket_, events, 0};
    while (!is_set(cancelled_) && wall_now() < deadline_) {
      const TimeNs left = std::clamp<TimeNs>(deadline_ - wall_now(), 0, kRetry);
      const timespec time{left / kNsPerSecond, left % kNsPerSecond};
      if (::ppoll(&descriptor, 1, &time, nullptr) > 0) {
        return true;
      }
    }
    reason_ = "no answer";
    return false;
  }

  bool fail(int error) {
    reason_ = std::strerror(error);
    return false;
  }

  void close_socket() {
    if (socket_ >= 0) {
      ::close(socket_);
      socket_ = -1;
    }
  }

  int socket_ = -1;
  TimeNs deadline_;
  const std::atomic<bool>* cancelled_;
  std::string reason_;
  bool unresolved_ = false;
};

std::string no_answer(const std::string& host, const Probe& probe) {
  return probe.unresolved()
             ? fmt::format(": {}, or set ROS_MASTER_URI to where the master is",
                           unresolved_host(host, probe.reason()))
             : fmt::format(" ({}); start one with roscore, or set ROS_MASTER_URI to where it is",
                           probe.reason());
}

}  // namespace

std::string master_uri(const topics::RosArguments& arguments) {
  const auto argument = arguments.find("__master");
  if (argument != arguments.end() && !argument->second.empty()) {
    return argument->second;
  }
  const char* const uri = std::getenv(kMasterVariable);
  return uri != nullptr && *uri != '\0' ? uri : "http://localhost:11311";
}

MasterAddress parse_master_uri(const std::string& uri) {
  constexpr std::string_view kScheme = "http://";
  std::string_view rest = uri;
  MasterAddress address;
  bool good = rest.starts_with(kScheme);
  if (good) {
    rest.remove_prefix(kScheme.size());
    rest = rest.substr(0, rest.find('/'));
    const auto colon = rest.rfind(':');
    const std::string_view digits = colon == rest.npos ? rest.substr(0, 0) : rest.substr(colon + 1);
    address.host = rest.substr(0, colon);
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, address.port);
    good = !digits.empty() && error == std::errc{} && stop == end && !address.host.empty() &&
           address.port != 0;
  }
  if (!good) {
    throw ConfigurationError(
        with_code(Code::ros_setting,
                  "ROS_MASTER_URI is '{}', which is not an address; write http://HOST:PORT, as in "
                  "http://localhost:11311",
                  uri));
  }
  return address;
}

bool require_master(const std::string& uri, TimeNs timeout, const std::atomic<bool>* cancelled) {
  const MasterAddress address = parse_master_uri(uri);
  const TimeNs deadline = wall_now() + timeout;
  for (TimeNs patience = kFirstPatience; !is_set(cancelled); patience *= 2) {
    const TimeNs now = wall_now();
    const TimeNs left = std::max(deadline - now, kLeastPatience);
    const Probe probe(address, now + std::min(left, patience), cancelled);
    if (probe.reason().empty()) {
      return true;
    }
    if (is_set(cancelled)) {
      break;
    }
    if (wall_now() + kRetry >= deadline) {
      throw TransportError(with_code(Code::no_ros_master, "no ROS master answers at {} within {}{}",
                                     uri, format_time(timeout), no_answer(address.host, probe)));
    }
    std::this_thread::sleep_for(std::chrono::nanoseconds(kRetry));
  }
  return false;
}

}  // namespace spikeloop::ros1
