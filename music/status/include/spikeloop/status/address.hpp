// What both ends of a Unix socket need.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <optional>
#include <string_view>

namespace spikeloop::status {

/// Nothing when the path is longer than the kernel allows, or empty.
inline std::optional<sockaddr_un> socket_address(std::string_view path) {
  sockaddr_un address{};
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    return std::nullopt;
  }
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, path.size());
  return address;
}

inline const sockaddr* generic(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

/// Asks for 1 MB; the kernel gives what its limits allow.
inline void enlarge(int fd, int which) {
  const int bytes = 1 << 20;
  setsockopt(fd, SOL_SOCKET, which, &bytes, sizeof bytes);
}

}  // namespace spikeloop::status
