// A continuous signal as messages of a ZeroMQ publisher, one a tick.
#pragma once

#include <memory>
#include <string>

#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::zmq {

struct PublisherSettings {
  std::string address;       ///< "tcp://127.0.0.1:5556": binds there
  std::string message_type;  ///< "FloatArray" or "GymCommand"
  double minimum = 0;        ///< GymCommand: the range that is sent with each value
  double maximum = 0;
  std::uint32_t width = 0;
};

/// Port: `in` [width]. Nothing is sent before the first value, nor a value that is not a finite
/// number. The values are sent as they are; those outside the range are counted.
///
/// Counters: messages, not_finite, outside_range.
class Publisher : public Sink {
 public:
  /// @throws ConfigurationError: another message type, GymCommand without a range, an impossible
  /// address; TransportError when the address is taken
  explicit Publisher(const PublisherSettings& settings);
  ~Publisher() override;
  /// Throws what the constructor would, but does not bind the address.
  static void check(const PublisherSettings& settings);

  std::vector<EndpointPort> ports() const override;
  void send(const Step& step) override;
  std::vector<Counter> counters() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::zmq
