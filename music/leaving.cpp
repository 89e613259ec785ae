// When a program of a job leaves its loop. Programs of ours say so; those of somebody else do not,
// and the others go on without them as if nothing had happened. `spikeloop run` preloads this
// MUSIC::Runtime::finalize(), which tells it the rank, and then calls MUSIC's.
//
// It enters programs of any kind: it needs libc alone.

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "next_function.hpp"

namespace {

sockaddr_un launcher{};  ///< its path is empty when there is none
int rank = 0;

/// As the launcher has set the variables: the program may change them.
[[gnu::constructor]] void read_variables() {
  const char* const path = getenv("SPIKELOOP_STATUS");
  const char* const number = getenv("OMPI_COMM_WORLD_RANK");
  if (path != nullptr && number != nullptr && strlen(path) < sizeof launcher.sun_path) {
    launcher.sun_family = AF_UNIX;
    strcpy(launcher.sun_path, path);
    rank = atoi(number);
  }
}

/// A datagram as music/status sends them. The launcher may be gone: that is no fault of the
/// program's.
void tell_launcher() {
  if (launcher.sun_path[0] == '\0') {
    return;
  }
  char text[80];
  const int length =
      snprintf(text, sizeof text, R"({"type":"leaving","process":"","rank":%d})", rank);
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  // Others may just fill its socket.
  const timeval patience{1, 0};
  setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  sendto(fd, text, static_cast<std::size_t>(length), MSG_NOSIGNAL,
         reinterpret_cast<const sockaddr*>(&launcher), sizeof launcher);
  close(fd);
}

}  // namespace

#define MUSIC_FINALIZE "_ZN5MUSIC7Runtime8finalizeEv"

extern "C" void leaving(void* runtime) asm(MUSIC_FINALIZE);

extern "C" void leaving(void* runtime) {
  tell_launcher();
  void* const found = spikeloop::next_function(MUSIC_FINALIZE, __builtin_return_address(0));
  if (found == nullptr) {
    fputs("MUSIC's finalize is not found\n", stderr);
    abort();
  }
  reinterpret_cast<void (*)(void*)>(found)(runtime);
}
