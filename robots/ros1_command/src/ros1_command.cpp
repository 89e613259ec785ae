#include "spikeloop/ros1_command/ros1_command.hpp"

#include <signal.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "spikeloop/ros1/master.hpp"

namespace spikeloop::ros1_command {
namespace {

/// What the guard has to know to stop the robot in our place.
guard::Hello guard_hello(const Address& address, const command::CommandSettings& settings,
                         const ros1::Publisher& publisher) {
  const std::vector<double> zero(settings.width, 0.0);
  return {.process = address.process,
          .topic = address.topic,
          .message_type = address.message_type,
          .master_uri = ros1::master_uri(),
          .watchdog = settings.watchdog,
          .zero = publisher.message(zero)};
}

}  // namespace

Ros1Command::Ros1Command(ros1::Session& session, const Address& address,
                         const command::CommandSettings& settings, Sent sent)
    : session_(session),
      publisher_(session, address.topic, address.message_type, address.fields),
      sent_(std::move(sent)),
      guard_(guard_hello(address, settings, publisher_)),
      sink_(settings, {.publish =
                           [this](auto values) {
                             const auto message = publisher_.publish(values);
                             if (sent_) {
                               sent_(message);
                             }
                             ++count_;
                           },
                       .finish =
                           [this] {
                             leave_to_guard_if_dead();
                             publisher_.drain();
                             guard_.done();
                           },
                       .interrupted = [] { ::kill(::getpid(), SIGTERM); },
                       .beat =
                           [this](TimeNs now) {
                             leave_to_guard_if_dead();
                             return guard_.beat(now);
                           },
                       .require = [this] { session_.require_alive(); }}),
      on_termination_([this] { sink_.stop(command::StopReason::terminated); }) {}

void Ros1Command::leave_to_guard_if_dead() {
  if (!session_.alive()) {
    guard_.abandon();
  }
}

}  // namespace spikeloop::ros1_command
