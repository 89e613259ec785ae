#include "ward.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::guard {
namespace {

/// How often we look whether a robot hears us, until one does.
constexpr TimeNs kLook = 5'000'000;

/// Until one of them can be read; a descriptor of -1 never can.
void wait(TimeNs deadline, int first, int second) {
  pollfd files[2] = {{first, POLLIN, 0}, {second, POLLIN, 0}};
  const TimeNs left = std::max<TimeNs>(0, deadline - wall_now());
  const timespec time{left / kNsPerSecond, left % kNsPerSecond};
  ::ppoll(files, 2, deadline == kNever ? nullptr : &time, nullptr);
}

}  // namespace

Ward::Ward(Descriptor socket, Robots& robots, std::function<void()> changed)
    : socket_(std::move(socket)),
      leave_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      robots_(robots),
      changed_(std::move(changed)),
      thread_([this] { run(); }) {}

Ward::~Ward() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(leave_.get(), &one, sizeof one);
  thread_.join();
}

void Ward::set_needed(bool needed) {
  if (needed_.exchange(needed) != needed) {
    changed_();
  }
}

void Ward::run() {
  if (read_introduction()) {
    if (const auto robot = advertise()) {
      watch(*robot);
    }
  }
  // The adapter is to see that nobody watches any more.
  socket_.reset();
  needed_.store(false);
  ended_.store(true);
  changed_();
}

bool Ward::read_introduction() {
  wait(kNever, socket_.get(), leave_.get());
  if (wait_readable(leave_.get(), 0)) {
    return false;
  }
  const Received first = receive_packet(socket_.get());
  if (first.closed || first.nothing) {
    return false;  // somebody has only looked whether a guard is there
  }
  const auto hello = read_hello(first.packet);
  if (!hello || hello->protocol != kProtocol) {
    refuse("guard and command adapter are of different versions of Spikeloop; use those of one");
    return false;
  }
  hello_ = *hello;
  return true;
}

std::unique_ptr<topics::RawPublisher> Ward::advertise() {
  try {
    auto robot = robots_.advertise(hello_);
    send_packet(socket_.get(), make_packet("ready"));
    return robot;
  } catch (const std::exception& error) {
    refuse(error.what());
    return nullptr;
  }
}

void Ward::refuse(const std::string& reason) {
  auto packet = make_packet("refused");
  packet["reason"] = reason;
  send_packet(socket_.get(), packet);
}

void Ward::watch(topics::RawPublisher& robot) {
  Vigil vigil(hello_.watchdog, wall_now());
  bool reaches = false;
  set_needed(true);
  while (!vigil.over() && (vigil.stopping() || !wait_readable(leave_.get(), 0))) {
    // What would always be ready must not keep us from waiting.
    const TimeNs look = reaches ? kNever : wall_now() + kLook;
    wait(std::min(vigil.next_due(), look), vigil.cause() == Cause::lost ? -1 : socket_.get(),
         vigil.stopping() ? -1 : leave_.get());
    // What has come while we had to wait for the processor counts before any deadline.
    listen(vigil);
    const bool heard = robot.has_subscribers();
    if (heard && !reaches) {
      reaches = true;
      send_packet(socket_.get(), make_packet("reaches"));
    }
    if (vigil.poll(wall_now(), heard)) {
      robot.publish(hello_.zero);
    }
    announce(vigil);
    // Not when it is over: leaving ROS may take as long as a master hangs.
    set_needed(!vigil.over() && (!vigil.cause() || vigil.stopping()));
  }
  robot.drain();
}

void Ward::listen(Vigil& vigil) {
  for (Received news = receive_packet(socket_.get()); !news.nothing;
       news = receive_packet(socket_.get())) {
    if (news.closed) {
      vigil.lost(wall_now());
      return;
    }
    const std::string type = type_of(news.packet);
    if (type == "beat") {
      vigil.beat(wall_now());
    } else if (type == "done") {
      vigil.done();
    }
  }
}

void Ward::announce(const Vigil& vigil) {
  const bool stopped_itself = vigil.over() && !vigil.cause();
  if (vigil.cause() == announced_ || stopped_itself) {
    return;
  }
  announced_ = vigil.cause();
  if (!announced_) {
    log::info("the command adapter '{}' is heard again", hello_.process);
  } else if (*announced_ == Cause::lost) {
    log::warning("the robot on {} is stopped: its command adapter '{}' has died", hello_.topic,
                 hello_.process);
  } else {
    log::warning(
        "the robot on {} is stopped: its command adapter '{}' has not been heard for {} (stopped "
        "by SIGSTOP, or the machine is too busy)",
        hello_.topic, hello_.process, format_time(vigil.deadline()));
  }
}

}  // namespace spikeloop::guard
