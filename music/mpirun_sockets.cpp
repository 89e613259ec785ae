// mpirun listens for the daemons of other hosts, on every address of the machine, and for the
// programs of its job, on 127.0.0.1. `spikeloop run` preloads this listen() into an mpirun whose
// job is on one machine. The function closes the daemon socket, and defers accept() until the first
// byte, because mpirun waits for silent connections at its end.
//
// Open MPI has no setting for either. The programs that mpirun starts inherit the library, so it
// does nothing in them.

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "next_function.hpp"

namespace {

/// TCP_DEFER_ACCEPT time-out in s, longer than any run waits
constexpr int kSilence = 3600;

bool is_mpirun() {
  return strcmp(program_invocation_short_name, "mpirun") == 0;
}

/// True if `fd` is bound to all addresses of the machine.
bool is_open_to_all(int fd) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return false;
  }
  if (address.ss_family == AF_INET6) {
    return IN6_IS_ADDR_UNSPECIFIED(&reinterpret_cast<const sockaddr_in6&>(address).sin6_addr) != 0;
  }
  return address.ss_family == AF_INET &&
         reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr == INADDR_ANY;
}

/// Replaces `fd` by a descriptor that is never readable: mpirun waits in select() for a connection.
int replace(int fd) {
  const int silent = eventfd(0, EFD_CLOEXEC);
  const int result = silent < 0 ? -1 : dup3(silent, fd, O_CLOEXEC);
  if (silent >= 0) {
    close(silent);
  }
  return result < 0 ? -1 : 0;
}

}  // namespace

extern "C" int listen(int fd, int backlog) noexcept {
  if (is_mpirun()) {
    if (is_open_to_all(fd)) {
      return replace(fd);
    }
    // The kernel keeps a connection to itself until its first byte arrives.
    setsockopt(fd, IPPROTO_TCP, TCP_DEFER_ACCEPT, &kSilence, sizeof kSilence);
  }
  void* const found = spikeloop::next_function("listen", __builtin_return_address(0));
  if (found == nullptr) {
    errno = ENOSYS;
    return -1;
  }
  return reinterpret_cast<int (*)(int, int)>(found)(fd, backlog);
}
