// A ZeroMQ socket that closes itself.
#pragma once

#include <zmq.h>

#include <optional>
#include <string>

namespace spikeloop::zmq {

class Socket {
 public:
  /// @param type ZMQ_SUB or ZMQ_PUB
  explicit Socket(int type);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// @throws ConfigurationError for an impossible address
  void connect(const std::string& address);
  /// @throws ConfigurationError for an impossible address, TransportError when it is taken
  void bind(const std::string& address);

  /// What has come, without waiting.
  std::optional<std::string> receive();
  /// Without waiting: ZeroMQ drops what its subscribers do not take.
  void send(const std::string& message);

 private:
  void* context_;
  void* socket_;
};

/// Seconds since 1970, for time stamps in messages.
double unix_time_s();

}  // namespace spikeloop::zmq
