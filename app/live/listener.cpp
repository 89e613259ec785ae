#include "listener.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

#include "spikeloop/core/error.hpp"

namespace spikeloop::view {
namespace {

constexpr int kPorts = 10;  // number of ports that are tried
constexpr int kBacklog = 1024;

sockaddr* generic(sockaddr_in& address) {
  return reinterpret_cast<sockaddr*>(&address);
}

bool listen_at(int socket, sockaddr_in address) {
  const int yes = 1;
  return ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)) == 0 &&
         ::bind(socket, generic(address), sizeof(address)) == 0 && ::listen(socket, kBacklog) == 0;
}

}  // namespace

std::string address_text(std::uint32_t address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  const in_addr bytes{address};
  ::inet_ntop(AF_INET, &bytes, text.data(), text.size());
  return text.data();
}

Listener::Listener(const std::string& host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  const bool is_address = ::inet_pton(AF_INET, host.c_str(), &address.sin_addr) == 1;
  int error = is_address ? EADDRINUSE : EADDRNOTAVAIL;
  for (int i = 0; error == EADDRINUSE && i < (port == 0 ? 1 : kPorts) && port + i <= UINT16_MAX;
       ++i) {
    socket_ = Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    address.sin_port = htons(static_cast<std::uint16_t>(port + i));
    error = listen_at(socket_.get(), address) ? 0 : errno;
  }
  if (error == EADDRNOTAVAIL) {
    throw TransportError(fmt::format(
        "the live view cannot listen at '{}', which is no IPv4 address of this machine; give one "
        "with --live-host, or 0.0.0.0 for all",
        host));
  }
  if (error != 0) {
    throw TransportError(fmt::format(
        "the live view cannot listen at {}:{} (nor at the {} ports behind it); give another port "
        "with --live-port, or 0 for any",
        host, port, kPorts - 1));
  }
}

std::uint16_t Listener::port() const {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  ::getsockname(socket_.get(), generic(address), &size);
  return ntohs(address.sin_port);
}

std::optional<Accepted> Listener::accept() const {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  const int socket =
      ::accept4(socket_.get(), generic(address), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (socket < 0 && (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM)) {
    throw TransportError("too many descriptors are open");
  }
  if (socket < 0) {
    return std::nullopt;
  }
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  return Accepted{Descriptor(socket), address.sin_addr.s_addr};
}

}  // namespace spikeloop::view
