#pragma once

#include <string>

#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop {

/// A free TCP port of this machine that the kernel gives to no other program while this object
/// lives. Nobody listens there until a program does that sets SO_REUSEADDR, as rosmaster and ZeroMQ
/// do (Linux: socket(7)).
class ReservedPort {
 public:
  /// @throws TransportError when no port is free.
  ReservedPort();
  int number() const { return number_; }
  std::string text() const { return std::to_string(number_); }

 private:
  Descriptor socket_;
  int number_ = 0;
};

}  // namespace spikeloop
