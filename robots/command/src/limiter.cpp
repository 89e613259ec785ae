#include "spikeloop/command/limiter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spikeloop::command {

Limiter::Limiter(std::vector<Bounds> bounds, std::size_t components)
    : bounds_(std::move(bounds)), values_(components) {
  bounds_.resize(components);
}

void Limiter::restart(std::span<const double> values, TimeNs now) {
  std::ranges::copy(values, values_.begin());
  time_ = now;
}

std::span<const double> Limiter::shape(std::span<const double> values, TimeNs now,
                                       bool accept_zero) {
  const double elapsed = to_seconds(std::max<TimeNs>(0, now - time_));
  std::optional<Cut> cut;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const Bounds& bounds = bounds_[i];
    const bool is_zero = accept_zero && bounds.zero_stops && values[i] == 0;
    const double target = is_zero ? 0 : std::clamp(values[i], bounds.minimum, bounds.maximum);
    if (target != values[i] && !cut) {
      cut = Cut{i, values[i]};
    }
    // Without a slew rate, take the target itself: a sum would round.
    const double way = std::isfinite(bounds.slew) ? bounds.slew * elapsed : bounds.slew;
    const bool reached = !std::isfinite(values_[i]) || std::fabs(target - values_[i]) <= way;
    values_[i] = reached ? target : values_[i] + std::copysign(way, target - values_[i]);
  }
  if (cut) {
    ++cuts_;
    first_cut_ = first_cut_ ? first_cut_ : cut;
  }
  time_ = std::max(time_, now);
  return values_;
}

}  // namespace spikeloop::command
