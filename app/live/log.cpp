#include "log.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <climits>
#include <string>

namespace spikeloop::view {
namespace {

constexpr std::size_t kMostBytes = 500;
static_assert(kMostBytes < PIPE_BUF / 2);

}  // namespace

void log_line(std::string_view text) {
  // The text can have bytes of a client, and the line is printed in the user's terminal.
  std::string shown(text.substr(0, kMostBytes));
  std::ranges::replace_if(
      shown, [](unsigned char c) { return std::isprint(c) == 0; }, '?');
  const std::string line = fmt::format("spikeloop-live: {}\n", shown);
  // A pipe is writable if it has room for PIPE_BUF bytes (pipe(7)).
  pollfd error{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&error, 1, 0) == 1 && (error.revents & POLLOUT) != 0) {
    [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, line.data(), line.size());
  }
}

}  // namespace spikeloop::view
