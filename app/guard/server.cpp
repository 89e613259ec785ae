#include "server.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <functional>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/guard/guard_timer.hpp"
#include "spikeloop/status/address.hpp"

namespace spikeloop::guard {
namespace {

constexpr int kBacklog = 64;
constexpr int kBeatMs = kGuardBeatPeriod / 1'000'000;
/// Each adapter takes a thread and two descriptors. Others wait until one of them has ended.
constexpr std::size_t kMostAdapters = 64;
/// Pause if no descriptor is free: the pending connection would make poll() return at once.
constexpr std::chrono::milliseconds kShortage{20};

Descriptor make_socket() {
  return Descriptor{socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
}

bool somebody_listens(const sockaddr_un& address) {
  const Descriptor probe = make_socket();
  return connect(probe.get(), status::generic(address), sizeof address) == 0 || errno == EAGAIN;
}

bool bind_to(int fd, const sockaddr_un& address) {
  // Only the user may connect, because a client can stop a robot.
  const mode_t before = umask(077);
  const bool bound = bind(fd, status::generic(address), sizeof address) == 0;
  umask(before);
  return bound;
}

/// Replaces a socket at which no process listens. @throws FileError
Descriptor listen_at(const std::string& path) {
  const auto address = status::socket_address(path);
  if (!address) {
    throw FileError("make the socket", path, ENAMETOOLONG);
  }
  Descriptor listener = make_socket();
  bool bound = bind_to(listener.get(), *address);
  struct stat file {};
  if (!bound && errno == EADDRINUSE && lstat(path.c_str(), &file) == 0 && S_ISSOCK(file.st_mode)) {
    if (somebody_listens(*address)) {
      throw FileError(
          fmt::format("another guard listens at '{}'; give another path with --socket", path));
    }
    unlink(path.c_str());
    bound = bind_to(listener.get(), *address);
  }
  if (!bound || listen(listener.get(), kBacklog) != 0) {
    throw FileError("make the socket", path, errno);
  }
  return listener;
}

}  // namespace

Server::Server(const std::string& path, int owner)
    : path_(path),
      listener_(listen_at(path)),
      wakeup_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      owner_(owner) {
  if (owner_ >= 0) {
    send_packet(owner_, {"listening"});
  }
}

Server::~Server() {
  unlink(path_.c_str());
}

void Server::run() {
  while (!signals_.next() &&
         (!owner_gone() || std::ranges::any_of(guarded_, &GuardedRobot::needed))) {
    if (owner_ >= 0) {
      send_beat(owner_);
    }
    turn();
    take_in();
    guarded_.remove_if(std::mem_fn(&GuardedRobot::ended));
  }
}

void Server::turn() {
  // An owner that has gone would always be ready.
  pollfd files[] = {{guarded_.size() < kMostAdapters ? listener_.get() : -1, POLLIN, 0},
                    {signals_.fd(), POLLIN, 0},
                    {wakeup_.get(), POLLIN, 0},
                    {owner_gone() ? -1 : owner_, POLLIN, 0}};
  poll(files, std::size(files), owner_gone() ? -1 : kBeatMs);
  std::uint64_t count = 0;
  [[maybe_unused]] const auto drained = read(wakeup_.get(), &count, sizeof count);
}

void Server::take_in() {
  while (guarded_.size() < kMostAdapters) {
    Descriptor adapter{accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK)};
    if (adapter.get() < 0) {
      if (errno != EAGAIN) {
        std::this_thread::sleep_for(kShortage);
      }
      return;
    }
    try {
      guarded_.emplace_back(
          std::move(adapter), robots_,
          GuardedRobot::Events{[this] { wake(); }, [this](const Hello& hello) { report(hello); }});
    } catch (const std::exception& error) {
      // The adapter warns that it is not guarded. The others stay guarded.
      log::warning("a command adapter cannot be guarded: {}", error.what());
    }
  }
}

void Server::wake() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(wakeup_.get(), &one, sizeof one);
}

void Server::report(const Hello& hello) const {
  if (owner_ >= 0) {
    send_packet(owner_, {"stopped", {{"topic", hello.topic}}});
  }
}

bool Server::owner_gone() const {
  return owner_ >= 0 && wait_readable(owner_, 0);
}

}  // namespace spikeloop::guard
