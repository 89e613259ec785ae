#include "spikeloop/ros1/master.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "ask.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::ros1 {
namespace {

constexpr TimeNs kRetry = 100'000'000;
/// Minimum time limit of a request, even with a timeout of zero.
constexpr TimeNs kLeastPatience = 500'000'000;
/// Time limit of the first request. The limit doubles with every request: under load a connection
/// may be lost, so that only a new one helps, but a slow master needs time to answer.
constexpr TimeNs kFirstPatience = 1'000'000'000;

bool is_set(const std::atomic<bool>* flag) {
  return flag != nullptr && flag->load();
}

std::string no_answer(const std::string& host, const Fault& fault) {
  return fault.kind == Fault::Kind::unresolved
             ? fmt::format(": {}, or set ROS_MASTER_URI to where the master is",
                           unresolved_host(host, fault.reason))
             : fmt::format(" ({}); start one with roscore, or set ROS_MASTER_URI to where it is",
                           fault.kind == Fault::Kind::other_program
                               ? "what answers there is no ROS master"
                               : fault.reason);
}

}  // namespace

std::string master_uri(const topics::RosArguments& arguments) {
  const auto argument = arguments.find("__master");
  if (argument != arguments.end() && !argument->second.empty()) {
    return argument->second;
  }
  const char* const uri = std::getenv(kMasterVariable);
  return uri != nullptr && *uri != '\0' ? uri : "http://localhost:11311";
}

MasterAddress parse_master_uri(const std::string& uri) {
  const auto address = parse_uri(uri);
  if (!address) {
    throw ConfigurationError(
        with_code(Code::ros_setting,
                  "ROS_MASTER_URI is '{}', which is not an address; write http://HOST:PORT, as in "
                  "http://localhost:11311",
                  uri));
  }
  return *address;
}

bool require_master(const std::string& uri, TimeNs timeout, const std::atomic<bool>* cancelled) {
  const MasterAddress address = parse_master_uri(uri);
  const TimeNs deadline = wall_now() + timeout;
  for (TimeNs patience = kFirstPatience; !is_set(cancelled); patience *= 2) {
    const TimeNs now = wall_now();
    const TimeNs left = std::max(deadline - now, kLeastPatience);
    const auto fault = ask_for_pid(address, {now + std::min(left, patience), cancelled});
    if (!fault) {
      return true;
    }
    if (is_set(cancelled)) {
      break;
    }
    if (wall_now() + kRetry >= deadline) {
      throw TransportError(with_code(Code::no_ros_master, "no ROS master answers at {} within {}{}",
                                     uri, format_time(timeout), no_answer(address.host, *fault)));
    }
    std::this_thread::sleep_for(std::chrono::nanoseconds(kRetry));
  }
  return false;
}

}  // namespace spikeloop::ros1
