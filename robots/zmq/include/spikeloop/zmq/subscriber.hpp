// A ZeroMQ publisher's newest message as a continuous signal.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::zmq {

struct SubscriberSettings {
  std::string address;       ///< "tcp://localhost:5555": connects there, now or when it comes up
  std::string message_type;  ///< see ObservationReader
  std::uint32_t width = 0;
  bool strict = false;
  std::optional<double> initial{};  ///< every channel before the first message; none: no value
};

/// Port: `out` [width]. Needs no thread: every step takes what has come and keeps the newest.
///
/// Counters: messages, cropped, short_messages, invalid_readings, malformed, late.
class Subscriber : public Source {
 public:
  /// @throws ConfigurationError for an impossible address or message type
  explicit Subscriber(const SubscriberSettings& settings);
  ~Subscriber() override;

  std::vector<EndpointPort> ports() const override;
  /// @throws ConfigurationError as ObservationReader::read
  void receive(const Step& step) override;
  std::vector<Counter> counters() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::zmq
