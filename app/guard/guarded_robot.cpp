#include "guarded_robot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/session/open.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::guard {
namespace {

/// Period of the checks for a subscriber, until there is one.
constexpr TimeNs kLook = 5'000'000;

/// An adapter sends its hello as soon as it is connected.
constexpr TimeNs kIntroduction = 2 * kNsPerSecond;
/// A node of ROS 2 needs no master. If it cannot be created, this machine lacks a resource, and the
/// robot must not be driven without its guard.
constexpr int kRos2 = 2;

/// Packets per turn, so that a flood does not delay the timer.
constexpr int kMostAtOnce = 100;

Descriptor make_event() {
  Descriptor event{eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  if (event.get() < 0) {
    throw std::system_error(errno, std::generic_category(), "eventfd");
  }
  return event;
}

/// Waits until `first` or `second` is readable, or the deadline; a descriptor of -1 is ignored.
void wait(TimeNs deadline, int first, int second) {
  pollfd files[2] = {{first, POLLIN, 0}, {second, POLLIN, 0}};
  const TimeNs left = std::max<TimeNs>(0, deadline - wall_now());
  const timespec time{left / kNsPerSecond, left % kNsPerSecond};
  ::ppoll(files, 2, deadline == kNever ? nullptr : &time, nullptr);
}

/// The adapter waits 5 s for the guard's answer.
constexpr TimeNs kMasterTimeout = 3 * kNsPerSecond;

/// "ROS_MASTER_URI=http://localhost:11311"
std::string to_text(const topics::Place& place) {
  std::vector<std::string> variables;
  for (const auto& [name, value] : place) {
    variables.push_back(fmt::format("{}={}", name, value));
  }
  return fmt::format("{}", fmt::join(variables, " "));
}

/// Arguments for the namespace of the robot's topic ("/left" of "/left/cmd_vel"), so that guards of
/// several robots have different names.
topics::RosArguments arguments_for(const std::string& topic) {
  const auto end = topic.rfind('/');
  return end == std::string::npos || end == 0
             ? topics::RosArguments{}
             : topics::RosArguments{{"__ns", topic.substr(0, end)}};
}

}  // namespace

std::unique_ptr<topics::RawPublisher> Robots::advertise(const Hello& hello) {
  const std::lock_guard lock(mutex_);
  Entered& entered = entered_[hello.ros];
  if (!entered.session) {
    session::Settings settings;
    settings.node_name = "spikeloop_guard";
    settings.unique_name = true;
    settings.warn_of_unreachable_nodes = false;  // the command adapter warns
    settings.arguments = arguments_for(hello.topic);
    settings.place = hello.place;
    settings.ros = topics::dialect_of(hello.ros);
    settings.master_timeout = kMasterTimeout;
    entered = {hello.place, session::open(settings), nullptr};
    entered.rosout = std::make_unique<topics::Rosout>(*entered.session);
  }
  if (hello.place != entered.place) {
    throw ConfigurationError(
        fmt::format("the guard uses {}, not {}; start another guard for this one",
                    to_text(entered.place), to_text(hello.place)));
  }
  return entered.session->publisher(hello.topic, hello.message_type);
}

GuardedRobot::GuardedRobot(Descriptor socket, Robots& robots, Events events)
    : socket_(std::move(socket)),
      leave_(make_event()),
      robots_(robots),
      events_(std::move(events)),
      thread_([this] { run(); }) {}

GuardedRobot::~GuardedRobot() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(leave_.get(), &one, sizeof one);
  thread_.join();
}

void GuardedRobot::set_needed(bool needed) {
  if (needed_.exchange(needed) != needed) {
    events_.changed();
  }
}

void GuardedRobot::run() {
  try {
    if (read_introduction()) {
      if (const auto robot = advertise()) {
        watch(*robot);
      }
    }
  } catch (const std::exception& error) {
    // The other robots stay guarded.
    log::warning("the robot on {} is not guarded any more: {}", hello_.topic, error.what());
  }
  // The adapter detects that it is not guarded any more.
  socket_.reset();
  needed_.store(false);
  ended_.store(true);
  events_.changed();
}

bool GuardedRobot::read_introduction() {
  wait(wall_now() + kIntroduction, socket_.get(), leave_.get());
  if (wait_readable(leave_.get(), 0)) {
    return false;
  }
  const Received first = receive_packet(socket_.get());
  if (first.closed || first.nothing) {
    return false;  // the client only tests whether a guard listens
  }
  const auto hello = read_hello(first.packet);
  if (!hello) {
    refuse("guard and command adapter are of different versions of Spikeloop; use those of one");
    return false;
  }
  hello_ = *hello;
  return true;
}

std::unique_ptr<topics::RawPublisher> GuardedRobot::advertise() {
  try {
    auto robot = robots_.advertise(hello_);
    // An adapter that has not waited for the answer sends another hello, and drives meanwhile.
    const bool waits = send_packet(socket_.get(), {"ready"}) == 0;
    return waits ? std::move(robot) : nullptr;
  } catch (const TransportError& error) {
    refuse(error.what(), hello_.ros == kRos2);
    return nullptr;
  } catch (const std::exception& error) {
    refuse(error.what());
    return nullptr;
  }
}

void GuardedRobot::refuse(const std::string& reason, bool ends_run) {
  Packet packet{"refused", {{"reason", reason}}};
  if (ends_run) {
    packet.fields[kEndsRun] = "1";
  }
  send_packet(socket_.get(), packet);
}

void GuardedRobot::watch(topics::RawPublisher& robot) {
  GuardTimer timer(hello_.watchdog, wall_now());
  bool reaches = false;
  TimeNs next_beat = 0;
  set_needed(true);
  while (!timer.over() && (timer.stopping() || !wait_readable(leave_.get(), 0))) {
    const TimeNs look = reaches ? kNever : wall_now() + kLook;
    if (timer.cause() == Cause::lost) {
      next_beat = kNever;
    } else if (wall_now() >= next_beat) {
      send_beat(socket_.get());
      next_beat = wall_now() + kGuardBeatPeriod;
    }
    wait(std::min({timer.next_due(), look, next_beat}),
         timer.cause() == Cause::lost ? -1 : socket_.get(), timer.stopping() ? -1 : leave_.get());
    // Packets that arrived while the thread waited for a processor count before any deadline.
    listen(timer);
    const bool has_subscriber = robot.has_subscribers();
    if (has_subscriber && !reaches) {
      reaches = true;
      send_packet(socket_.get(), {"reaches"});
    }
    if (timer.poll(wall_now(), has_subscriber)) {
      stop(robot);
    }
    announce(timer);
    // The guard is not needed after the stop, even if leaving ROS waits for a master that hangs.
    set_needed(!timer.over() && (!timer.cause() || timer.stopping()));
  }
  if (timer.over() && timer.cause() && timer.robot_stopped()) {
    events_.stopped(hello_);
  }
  robot.drain();
}

/// Sends nothing to a robot that was not driven and whose position is not known.
void GuardedRobot::stop(topics::RawPublisher& robot) {
  if (!hello_.stop.empty()) {
    robot.publish(hello_.stop);
  }
}

void GuardedRobot::listen(GuardTimer& timer) {
  for (int i = 0; i < kMostAtOnce; ++i) {
    const Received news = receive_packet(socket_.get());
    if (news.nothing) {
      return;
    }
    const std::string type = news.packet.type;
    if (news.closed || type.empty()) {  // not a packet: the client is not an adapter
      timer.lost(wall_now());
      return;
    }
    if (type == "beat") {
      timer.beat(wall_now());
    } else if (type == "stop") {
      hello_.stop = stop_message(news.packet);
    } else if (type == "done") {
      timer.done();
    }
  }
}

void GuardedRobot::announce(const GuardTimer& timer) {
  const bool stopped_itself = timer.over() && !timer.cause();
  if (timer.cause() == announced_ || stopped_itself) {
    return;
  }
  announced_ = timer.cause();
  if (!announced_) {
    log::info("the command adapter '{}' is heard again", hello_.process);
  } else if (*announced_ == Cause::lost) {
    log::warning("the robot on {} is stopped: its command adapter '{}' has died", hello_.topic,
                 hello_.process);
  } else {
    log::warning(
        "the robot on {} is stopped: its command adapter '{}' has not been heard for {} (stopped "
        "by SIGSTOP, or the machine is too busy)",
        hello_.topic, hello_.process, format_time(timer.deadline()));
  }
}

}  // namespace spikeloop::guard
