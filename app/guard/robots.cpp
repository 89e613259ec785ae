#include "robots.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/session/open.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::guard {
namespace {

/// The adapter waits 5 s for our answer.
constexpr TimeNs kMasterTimeout = 3 * kNsPerSecond;

/// "ROS_MASTER_URI=http://localhost:11311"
std::string to_text(const topics::Place& place) {
  std::vector<std::string> variables;
  for (const auto& [name, value] : place) {
    variables.push_back(fmt::format("{}={}", name, value));
  }
  return fmt::format("{}", fmt::join(variables, " "));
}

/// In the namespace of the robot's topic, so that guards of several robots have different names:
/// "/left" of "/left/cmd_vel".
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
        fmt::format("it meets robots at {}, not at {}; start another guard for this one",
                    to_text(entered.place), to_text(hello.place)));
  }
  return entered.session->publisher(hello.topic, hello.message_type);
}

}  // namespace spikeloop::guard
