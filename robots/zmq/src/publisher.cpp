#include "spikeloop/zmq/publisher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "socket.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/zmq/address.hpp"
#include "spikeloop/zmq/wire.hpp"

namespace spikeloop::zmq {
namespace {

constexpr const char* kGymCommand = "GymCommand";

}  // namespace

struct Publisher::Impl {
  explicit Impl(const PublisherSettings& wanted)
      : settings(wanted), gym(wanted.message_type == kGymCommand) {
    check(settings);
    socket.bind(settings.address);
  }

  PublisherSettings settings;
  bool gym;
  Socket socket{ZMQ_PUB};
  std::uint64_t messages = 0;
  std::uint64_t not_finite = 0;
  std::uint64_t outside_range = 0;
};

void Publisher::check(const PublisherSettings& settings) {
  check_bind_address(settings.address);
  const bool gym = settings.message_type == kGymCommand;
  if (!gym && settings.message_type != "FloatArray") {
    throw ConfigurationError(
        with_code(Code::unknown_message,
                  "message_type '{}' is not known; write message_type=GymCommand or FloatArray",
                  settings.message_type));
  }
  if (gym && !(settings.minimum < settings.maximum)) {
    throw ConfigurationError(
        with_code(Code::wrong_order,
                  "a GymCommand carries its range, but min is {} and max {}; write min below "
                  "max, as in min=-1 and max=1",
                  settings.minimum, settings.maximum));
  }
}

Publisher::Publisher(const PublisherSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}

Publisher::~Publisher() = default;

std::vector<EndpointPort> Publisher::ports() const {
  return {{"in", PortKind::signal, impl_->settings.width}};
}

void Publisher::send(const Step& step) {
  const SignalInput in = step.signal_input();
  if (!in.valid()) {
    return;
  }
  const auto& [address, type, low, high, width] = impl_->settings;
  if (!std::ranges::all_of(in.values, [](double value) { return std::isfinite(value); })) {
    ++impl_->not_finite;
    return;
  }
  if (impl_->gym && std::ranges::any_of(in.values, [low = low, high = high](double value) {
        return value < low || value > high;
      })) {
    ++impl_->outside_range;
  }
  impl_->socket.send(impl_->gym ? gym_command(in.values, low, high, unix_time_s())
                                : float_array(in.values));
  ++impl_->messages;
}

std::vector<Counter> Publisher::counters() const {
  return {{"messages", impl_->messages},
          {"not_finite", impl_->not_finite},
          {"outside_range", impl_->outside_range}};
}

}  // namespace spikeloop::zmq
