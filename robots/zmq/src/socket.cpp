#include "socket.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/zmq/address.hpp"

namespace spikeloop::zmq {
namespace {

constexpr int kLingerMs = 100;

[[noreturn]] void fail(const std::string& address, int error) {
  const char* const reason = ::zmq_strerror(error);
  const bool is_file = address.starts_with("ipc://");
  if (error == EADDRINUSE || error == EACCES || (is_file && error == ENOENT)) {
    throw TransportError(with_code(Code::invalid_topic,
                                   "cannot bind {}: {}; write another {} in zmq_addr", address,
                                   reason, is_file ? "path" : "port"));
  }
  throw ConfigurationError(with_code(
      Code::invalid_topic,
      "zmq_addr '{}' is not an address of this machine ({}); write tcp://*:PORT to publish "
      "on every interface",
      address, reason));
}

/// ZeroMQ takes over the file of an ipc:// address that another program is bound to.
bool is_taken_file(const std::string& address) {
  constexpr std::size_t kScheme = 6;
  sockaddr_un place{};
  place.sun_family = AF_UNIX;
  if (!address.starts_with("ipc://") || address.size() - kScheme >= sizeof place.sun_path) {
    return false;
  }
  address.copy(place.sun_path, sizeof place.sun_path - 1, kScheme);
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool answers =
      ::connect(probe, reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0 ||
      errno == EPROTOTYPE;  // a socket of another kind, but somebody's
  ::close(probe);
  return answers;
}

}  // namespace

Socket::Socket(int type) : context_(::zmq_ctx_new()), socket_(::zmq_socket(context_, type)) {
  if (socket_ == nullptr) {
    throw TransportError(with_code(Code::invalid_topic,
                                   "cannot open a ZeroMQ socket: {}; raise the limit of open "
                                   "files (ulimit -n)",
                                   ::zmq_strerror(::zmq_errno())));
  }
  ::zmq_setsockopt(socket_, ZMQ_LINGER, &kLingerMs, sizeof kLingerMs);
  if (type == ZMQ_SUB) {
    ::zmq_setsockopt(socket_, ZMQ_SUBSCRIBE, "", 0);
  }
}

Socket::~Socket() {
  ::zmq_close(socket_);
  ::zmq_ctx_term(context_);
}

void Socket::connect(const std::string& address) {
  check_connect_address(address);
  if (::zmq_connect(socket_, address.c_str()) != 0) {
    fail(address, ::zmq_errno());
  }
}

void Socket::bind(const std::string& address) {
  check_bind_address(address);
  if (is_taken_file(address)) {
    fail(address, EADDRINUSE);
  }
  if (::zmq_bind(socket_, address.c_str()) != 0) {
    fail(address, ::zmq_errno());
  }
}

std::optional<std::string> Socket::receive() {
  zmq_msg_t message;
  ::zmq_msg_init(&message);
  std::optional<std::string> text;
  if (::zmq_msg_recv(&message, socket_, ZMQ_DONTWAIT) >= 0) {
    text.emplace(static_cast<const char*>(::zmq_msg_data(&message)), ::zmq_msg_size(&message));
  }
  ::zmq_msg_close(&message);
  return text;
}

void Socket::send(const std::string& message) {
  ::zmq_send(socket_, message.data(), message.size(), ZMQ_DONTWAIT);
}

double unix_time_s() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration<double>(since).count();
}

}  // namespace spikeloop::zmq
