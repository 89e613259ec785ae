#include "spikeloop/launch/ros_master.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <memory>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::launch {
namespace {

using Clock = std::chrono::steady_clock;
/// Under load a connection may be lost, and then only a new one helps.
constexpr std::chrono::seconds kAttempts[] = {std::chrono::seconds{1}, std::chrono::seconds{2}};
/// getPublishedTopics of a large robot is some 100 kB.
constexpr std::size_t kLargestAnswer = 16u << 20;

bool wait_for(int fd, short events, Clock::time_point deadline) {
  while (true) {
    // Rounded up: who gives up before the deadline is taken for one that got an answer.
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd file{fd, events, 0};
    const int ready = poll(&file, 1, static_cast<int>(std::max<long>(left.count(), 0)));
    if (ready >= 0 || errno != EINTR) {
      return ready > 0;
    }
  }
}

Descriptor connect_to(const addrinfo& address, Clock::time_point deadline) {
  Descriptor fd{socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  int error = 0;
  if (connect(fd.get(), address.ai_addr, address.ai_addrlen) != 0) {
    error = errno;
    if (error == EINPROGRESS && wait_for(fd.get(), POLLOUT, deadline)) {
      socklen_t size = sizeof error;
      getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &error, &size);
    }
  }
  return error == 0 ? std::move(fd) : Descriptor{};
}

struct Addresses {
  std::unique_ptr<addrinfo, void (*)(addrinfo*)> first{nullptr, freeaddrinfo};
  int error = 0;  ///< getaddrinfo's
};

Addresses resolve(const MasterAddress& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  Addresses result;
  result.error =
      getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
  if (result.error == 0) {
    result.first.reset(found);
  }
  return result;
}

Descriptor connect_to(const MasterAddress& address, Clock::time_point deadline) {
  const Addresses found = resolve(address);
  Descriptor fd;
  for (const addrinfo* entry = found.first.get(); entry != nullptr && fd.get() < 0;
       entry = entry->ai_next) {
    fd = connect_to(*entry, deadline);
  }
  return fd;
}

bool write_all(int fd, std::string_view text, Clock::time_point deadline) {
  while (!text.empty()) {
    const auto size = send(fd, text.data(), text.size(), MSG_NOSIGNAL);
    if (size > 0) {
      text.remove_prefix(static_cast<std::size_t>(size));
    } else if (errno != EAGAIN || !wait_for(fd, POLLOUT, deadline)) {
      return false;
    }
  }
  return true;
}

/// Reads to the end of the connection, or to the end of the XML.
std::string read_answer(int fd, Clock::time_point deadline) {
  std::string answer;
  char buffer[16384];
  while (answer.size() < kLargestAnswer && answer.find("</methodResponse>") == std::string::npos &&
         wait_for(fd, POLLIN, deadline)) {
    const auto size = recv(fd, buffer, sizeof buffer, 0);
    if (size <= 0) {
      break;
    }
    answer.append(buffer, static_cast<std::size_t>(size));
  }
  return answer;
}

/// Empty when there was no answer.
std::string ask(const MasterAddress& address, std::string_view request,
                Clock::time_point deadline) {
  const Descriptor fd = connect_to(address, deadline);
  return fd.get() >= 0 && write_all(fd.get(), request, deadline) ? read_answer(fd.get(), deadline)
                                                                 : "";
}

bool is_good(const std::string& answer) {
  return answer.find(" 200 ") < answer.find('\n') &&
         answer.find("</methodResponse>") != std::string::npos &&
         answer.find("<fault>") == std::string::npos;
}

std::string text_value(std::string_view text) {
  return fmt::format("<param><value><string>{}</string></value></param>", text);
}

}  // namespace

MasterAddress parse_master_uri(std::string_view uri) {
  const auto fail = [uri]() -> ConfigurationError {
    return ConfigurationError(
        with_code(Code::no_ros_master,
                  "ROS_MASTER_URI is '{}', which is not a master's address; write "
                  "http://HOST:PORT, such as {}",
                  uri, kDefaultMasterUri));
  };
  constexpr std::string_view kScheme = "http://";
  std::string_view rest = uri;
  if (!rest.starts_with(kScheme)) {
    throw fail();
  }
  rest.remove_prefix(kScheme.size());
  if (rest.ends_with('/')) {
    rest.remove_suffix(1);
  }
  const auto colon = rest.rfind(':');
  if (colon == std::string_view::npos || colon == 0) {
    throw fail();
  }
  MasterAddress address{std::string(rest.substr(0, colon)), 0};
  const std::string_view port = rest.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (error != std::errc() || end != port.data() + port.size() || address.port == 0) {
    throw fail();
  }
  return address;
}

std::string master_uri() {
  const char* uri = std::getenv("ROS_MASTER_URI");
  return uri == nullptr || *uri == '\0' ? kDefaultMasterUri : uri;
}

RosMaster::RosMaster(const std::string& uri) : uri_(uri), address_(parse_master_uri(uri)) {}

std::optional<std::string> RosMaster::call(const std::string& method,
                                           const std::string& arguments) const {
  const std::string body = fmt::format(
      "<?xml version=\"1.0\"?><methodCall><methodName>{}</methodName><params>{}{}</params>"
      "</methodCall>",
      method, text_value("/spikeloop"), arguments);
  const std::string request = fmt::format(
      "POST /RPC2 HTTP/1.0\r\nHost: {}:{}\r\nContent-Type: text/xml\r\nContent-Length: "
      "{}\r\n\r\n{}",
      address_.host, address_.port, body.size(), body);
  for (const auto patience : kAttempts) {
    const auto deadline = Clock::now() + patience;
    std::string answer = ask(address_, request, deadline);
    if (is_good(answer)) {
      return answer;
    }
    if (Clock::now() < deadline) {
      break;  // refused, or no master: it would be so again
    }
  }
  return std::nullopt;
}

bool RosMaster::answers() const {
  return call("getUri", "").has_value();
}

std::string RosMaster::unresolved() const {
  const int error = resolve(address_).error;
  return error == 0 ? "" : unresolved_host(address_.host, gai_strerror(error));
}

bool RosMaster::publishes(const std::string& topic) const {
  auto answer = call("getPublishedTopics", text_value(""));
  if (!answer) {
    return false;
  }
  std::erase_if(*answer, [](unsigned char c) { return std::isspace(c) != 0; });
  return answer->find(fmt::format(">{}<", topic)) != std::string::npos;
}

std::vector<std::string> RosMaster::publishers(const std::string& topic) const {
  constexpr std::string_view kBegin = "<string>";
  constexpr std::string_view kEnd = "</string>";
  if (!publishes(topic)) {
    return {};  // the name may still stand there, as a subscriber's topic
  }
  auto answer = call("getSystemState", "").value_or("");
  std::erase_if(answer, [](unsigned char c) { return std::isspace(c) != 0; });
  // Lists of [topic, [node, ...]], the publishers' first.
  const std::string entry = fmt::format("<string>{}</string></value><value><array>", topic);
  const auto begin = answer.find(entry);
  if (begin == std::string::npos) {
    return {};
  }
  std::string_view list = std::string_view(answer).substr(begin + entry.size());
  list = list.substr(0, list.find("</array>"));
  std::vector<std::string> nodes;
  for (auto at = list.find(kBegin); at != std::string_view::npos; at = list.find(kBegin)) {
    list.remove_prefix(at + kBegin.size());
    nodes.emplace_back(list.substr(0, list.find(kEnd)));
  }
  return nodes;
}

bool RosMaster::is_alive(const std::string& node) const {
  const std::string answer = call("lookupNode", text_value(node)).value_or("");
  const auto begin = answer.find("http://");
  if (begin == std::string::npos) {
    return false;
  }
  try {
    return RosMaster(answer.substr(begin, answer.find('<', begin) - begin))
        .call("getPid", "")
        .has_value();
  } catch (const ConfigurationError&) {
    return false;  // an address that nobody can have
  }
}

}  // namespace spikeloop::launch
