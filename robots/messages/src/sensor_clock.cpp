#include "spikeloop/messages/sensor_clock.hpp"

namespace spikeloop::messages {

void SensorClock::take(TimeNs newest, TimeNs now) {
  const bool jumped = set_ && (newest < newest_ || simulated(newest) > now + kFarthest);
  if (!set_ || jumped) {
    offset_ = now - newest;
  }
  jumps_ += jumped ? 1 : 0;
  newest_ = newest;
  set_ = true;
}

}  // namespace spikeloop::messages
