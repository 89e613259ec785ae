#include "spikeloop/zmq/subscriber.hpp"

#include <algorithm>

#include "socket.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/zmq/wire.hpp"

namespace spikeloop::zmq {

struct Subscriber::Impl {
  explicit Impl(const SubscriberSettings& wanted)
      : settings(wanted), reader(wanted.message_type, wanted.width, wanted.strict) {
    socket.connect(settings.address);
  }

  /// True when a message has brought values.
  bool take_all() {
    bool any = false;
    while (const auto message = socket.receive()) {
      any = reader.read(*message, unix_time_s()) || any;
      const std::string warning = reader.take_warning();
      if (!warning.empty()) {
        log::warning("{}: {}", settings.address, warning);
      }
    }
    return any;
  }

  SubscriberSettings settings;
  ObservationReader reader;
  Socket socket{ZMQ_SUB};
};

Subscriber::Subscriber(const SubscriberSettings& settings)
    : impl_(std::make_unique<Impl>(settings)) {}

Subscriber::~Subscriber() = default;

std::vector<EndpointPort> Subscriber::ports() const {
  return {{"out", PortKind::signal, impl_->settings.width}};
}

void Subscriber::receive(const Step& step) {
  const SignalOutput out = step.signal_output();
  if (impl_->take_all()) {
    std::ranges::copy(impl_->reader.channels(), out.values().begin());
    out.commit();
  } else if (impl_->settings.initial) {
    std::ranges::fill(out.values(), *impl_->settings.initial);
    out.commit();
  }
  impl_->settings.initial.reset();  // of the first step only
}

std::vector<Counter> Subscriber::counters() const {
  const auto& counts = impl_->reader.counts();
  return {{"messages", counts.messages},
          {"cropped", counts.cropped},
          {"short_messages", counts.short_messages},
          {"invalid_readings", counts.invalid_readings},
          {"malformed", counts.malformed},
          {"late", counts.late}};
}

}  // namespace spikeloop::zmq
