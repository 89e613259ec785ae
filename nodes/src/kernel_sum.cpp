#include "kernel_sum.hpp"

namespace spikeloop {

void KernelSum::prepare(TimeNs end) {
  constexpr double kReach = 32.0;  // in tau; exp(32) is far from overflow and nearly exact
  if (static_cast<double>(end - reference_) <= kReach * tau_) {
    return;
  }
  const double scale = decay(end);
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    sum_[i] *= scale;
    error_[i] *= scale;
  }
  reference_ = end;
}

}  // namespace spikeloop
