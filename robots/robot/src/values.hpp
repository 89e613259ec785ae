// Values of message fields.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "spikeloop/core/time.hpp"
#include "spikeloop/messages/message_writer.hpp"

namespace spikeloop::robot {

/// Whole seconds and the nanoseconds after them, exactly.
struct Stamp {
  explicit Stamp(TimeNs time) : Stamp(time / kNsPerSecond, time % kNsPerSecond) {}
  Stamp(std::int64_t whole, std::int64_t rest)
      : secs(static_cast<double>(whole)), nsecs(static_cast<double>(rest)) {}
  double secs;
  double nsecs;
};

inline messages::FieldValue number(const double& value) {
  return {std::span(&value, 1), {}};
}
inline messages::FieldValue numbers(std::span<const double> values) {
  return {values, {}};
}
inline messages::FieldValue text(std::string_view value) {
  return {{}, value};
}

}  // namespace spikeloop::robot
