#include "ask.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <condition_variable>
#include <cstring>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>

#include "spikeloop/core/pacer.hpp"

namespace spikeloop::ros1 {
namespace {

constexpr TimeNs kLook = 100'000'000;

bool may_wait(const Limit& limit) {
  return !(limit.cancelled != nullptr && limit.cancelled->load()) && wall_now() < limit.deadline;
}

using Addresses = std::unique_ptr<addrinfo, void (*)(addrinfo*)>;

/// Shared by the waiting thread and the thread of getaddrinfo(), which cannot be cancelled and
/// waits for name servers that do not answer.
struct Resolution {
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  int error = 0;
  Addresses addresses{nullptr, ::freeaddrinfo};
};

void resolve(const std::shared_ptr<Resolution>& resolution, const Address& address) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  const int error =
      ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &list);
  const std::lock_guard lock(resolution->mutex);
  if (error == 0) {
    resolution->addresses.reset(list);
  }
  resolution->error = error;
  resolution->done = true;
  resolution->changed.notify_one();
}

constexpr std::size_t kLongestHeader = 1'000'000;

/// Length in little endian, as in TCPROS.
std::string length_of(const std::string& text) {
  std::string bytes(4, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<char>(text.size() >> (8 * i) & 0xFF);
  }
  return bytes;
}

std::size_t read_length(std::string_view bytes) {
  std::size_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    length |= std::size_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  }
  return length;
}

/// One connection for one request.
class Question {
 public:
  Question(const Address& address, const Limit& limit) : address_(address), limit_(limit) {}
  ~Question() { close_socket(); }
  Question(const Question&) = delete;
  Question& operator=(const Question&) = delete;

  bool connect() {
    const auto resolution = std::make_shared<Resolution>();
    std::thread(resolve, resolution, address_).detach();
    std::unique_lock lock(resolution->mutex);
    while (!resolution->done && may_wait(limit_)) {
      resolution->changed.wait_for(lock, std::chrono::nanoseconds(kLook));
    }
    if (!resolution->done || resolution->error != 0) {
      return fail(Fault::Kind::unresolved, resolution->done ? ::gai_strerror(resolution->error)
                                                            : "the name servers do not answer");
    }
    fail(Fault::Kind::ipv6_only, "no IPv4 address");
    for (const addrinfo* each = resolution->addresses.get(); each != nullptr;
         each = each->ai_next) {
      if ((each->ai_family == AF_INET || limit_.ipv6) && connect_to(*each)) {
        return true;
      }
    }
    return false;
  }

  bool ask_for_pid() { return send_request() && receive_status(); }

  /// A field of TCPROS consists of its length and "key=value".
  bool ask_for_header(const std::string& self, const std::string& topic,
                      std::map<std::string, std::string>& header) {
    std::string fields;
    for (const std::string& field :
         {"callerid=" + self, "topic=" + topic, std::string("type=*"), std::string("md5sum=*")}) {
      fields += length_of(field) + field;
    }
    return send_text(length_of(fields) + fields) && receive_header(header);
  }

  const std::optional<Fault>& fault() const { return fault_; }

 private:
  bool connect_to(const addrinfo& address) {
    close_socket();
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

  bool send_request() {
    const std::string_view body =
        "<?xml version=\"1.0\"?><methodCall><methodName>getPid</methodName><params><param>"
        "<value><string>/spikeloop</string></value></param></params></methodCall>";
    const std::string request = fmt::format(
        "POST / HTTP/1.0\r\nHost: {}:{}\r\nContent-Type: text/xml\r\n"
        "Content-Length: {}\r\n\r\n{}",
        address_.host, address_.port, body.size(), body);
    return send_text(request);
  }

  /// Does not block: a few hundred bytes fit the empty buffer of a new connection.
  bool send_text(const std::string& text) {
    const auto sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
    return sent == static_cast<ssize_t>(text.size()) || fail(errno);
  }

  bool receive_header(std::map<std::string, std::string>& header) {
    std::string length;
    std::string fields;
    if (!receive(length, 4)) {
      return false;
    }
    if (read_length(length) > kLongestHeader) {
      return fail(Fault::Kind::other_program, "another program answers there");
    }
    if (!receive(fields, read_length(length))) {
      return false;
    }
    for (std::size_t at = 0; at + 4 <= fields.size();) {
      const std::size_t size = read_length(std::string_view(fields).substr(at));
      const std::string field = fields.substr(at + 4, size);
      at += 4 + size;
      if (const auto equals = field.find('='); equals != std::string::npos) {
        header[field.substr(0, equals)] = field.substr(equals + 1);
      }
    }
    return true;
  }

  bool receive(std::string& bytes, std::size_t size) {
    while (bytes.size() < size) {
      if (!wait(POLLIN)) {
        return false;
      }
      char buffer[1024];
      const auto count = ::recv(socket_, buffer, std::min(sizeof buffer, size - bytes.size()), 0);
      if (count <= 0) {
        return fail(Fault::Kind::other_program, "it closes the connection");
      }
      bytes.append(buffer, static_cast<std::size_t>(count));
    }
    return true;
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
    return (answer.starts_with("HTTP/") && answer.find(" 200 ") != std::string::npos) ||
           fail(Fault::Kind::other_program, "another program answers there");
  }

  bool wait(short events) {
    pollfd descriptor{socket_, events, 0};
    while (may_wait(limit_)) {
      const TimeNs left = std::clamp<TimeNs>(limit_.deadline - wall_now(), 0, kLook);
      const timespec time{left / kNsPerSecond, left % kNsPerSecond};
      if (::ppoll(&descriptor, 1, &time, nullptr) > 0) {
        return true;
      }
    }
    return fail(Fault::Kind::silent, "no answer");
  }

  bool fail(int error) { return fail(Fault::Kind::silent, std::strerror(error)); }
  bool fail(Fault::Kind kind, std::string reason) {
    fault_ = {kind, std::move(reason)};
    return false;
  }

  void close_socket() {
    if (socket_ >= 0) {
      ::close(socket_);
      socket_ = -1;
    }
  }

  const Address& address_;
  const Limit& limit_;
  int socket_ = -1;
  std::optional<Fault> fault_;
};

/// Numeric form of an IP address.
std::string text_of(const sockaddr* address, socklen_t size) {
  char text[NI_MAXHOST];
  return ::getnameinfo(address, size, text, sizeof text, nullptr, 0, NI_NUMERICHOST) == 0 ? text
                                                                                          : "";
}

}  // namespace

std::optional<Address> parse_uri(const std::string& uri) {
  constexpr std::string_view kScheme = "http://";
  if (!uri.starts_with(kScheme)) {
    return std::nullopt;
  }
  std::string_view rest = std::string_view(uri).substr(kScheme.size());
  rest = rest.substr(0, rest.find('/'));
  const auto colon = rest.rfind(':');
  if (colon == rest.npos || colon == 0) {
    return std::nullopt;
  }
  Address address;
  address.host = rest.substr(0, colon);
  const std::string_view digits = rest.substr(colon + 1);
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, address.port);
  const bool good = error == std::errc{} && stop == end && address.port != 0;
  return good ? std::optional(address) : std::nullopt;
}

bool is_loopback(const std::string& host) {
  return host == "localhost" || host.starts_with("127.") || host == "::1";
}

std::uint16_t port_of(int socket, int (*name)(int, sockaddr*, socklen_t*) noexcept) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (name(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return 0;
  }
  switch (address.ss_family) {
    case AF_INET:
      return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
    case AF_INET6:
      return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
    default:
      return 0;
  }
}

std::string own_address_towards(const Address& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;  // connecting it sends nothing
  addrinfo* list = nullptr;
  if (::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &list) !=
      0) {
    return {};
  }
  const Addresses owner(list, ::freeaddrinfo);
  const int socket = ::socket(list->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  auto* const generic = reinterpret_cast<sockaddr*>(&own);
  const bool known = socket >= 0 && ::connect(socket, list->ai_addr, list->ai_addrlen) == 0 &&
                     ::getsockname(socket, generic, &size) == 0;
  ::close(socket);
  const std::string text = known ? text_of(generic, size) : "";
  return text == text_of(list->ai_addr, list->ai_addrlen) || is_loopback(text) ? "" : text;
}

std::optional<Fault> ask_for_pid(const Address& address, const Limit& limit) {
  Question question(address, limit);
  return question.connect() && question.ask_for_pid() ? std::nullopt : question.fault();
}

std::optional<Fault> ask_for_header(const Address& address, const Limit& limit,
                                    const std::string& self, const std::string& topic,
                                    std::map<std::string, std::string>& header) {
  Question question(address, limit);
  return question.connect() && question.ask_for_header(self, topic, header) ? std::nullopt
                                                                            : question.fault();
}

}  // namespace spikeloop::ros1
