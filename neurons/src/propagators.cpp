#include "propagators.hpp"

#include <algorithm>
#include <cmath>

namespace spikeloop::neurons {

double decay(double h, double tau) {
  return std::exp(-h / tau);
}

double current_to_membrane(double h, double tau_m, double tau_syn, double C_m) {
  // The slower exponential taken out of the integral leaves exp(-rate * s) with rate >= 0, and
  // expm1 keeps its integral exact down to rate = 0, where the textbook form divides zero by zero.
  const double slow = std::max(tau_m, tau_syn);
  const double fast = std::min(tau_m, tau_syn);
  const double rate = (slow - fast) / (slow * fast);
  const double integral = rate == 0.0 ? h : -std::expm1(-rate * h) / rate;
  return decay(h, slow) * integral / C_m;
}

double constant_to_membrane(double h, double tau_m, double C_m) {
  return -std::expm1(-h / tau_m) * tau_m / C_m;
}

long refractory_steps(const NeuronParameters& parameters, TimeNs resolution) {
  const auto t_ref = static_cast<TimeNs>(std::llround(parameters.t_ref * 1e6));
  return static_cast<long>((t_ref + resolution - 1) / resolution);
}

}  // namespace spikeloop::neurons
