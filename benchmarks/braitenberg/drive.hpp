// The example's loop through the library: beams -> rates -> spikes -> linear readout -> Twist on
// the simulated physics, without ROS and MUSIC, a hundred times faster than real time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::braitenberg {

inline constexpr std::size_t kBeams = 100;

/// What readout_weights.json and mapping.json say: channel 0 is the speed in m/s, 1 the yaw rate in
/// rad/s.
struct Readout {
  struct Channel {
    std::vector<double> weights;  ///< [kBeams], a hertz
    double offset = 0;
    double minimum = 0;
    double maximum = 0;
  };
  std::array<Channel, 2> channels;
};

struct Drive {
  std::uint64_t seed = 1;  ///< of the arena
  TimeNs delay = 0;  ///< from spikes to wheels, besides the readout's and the sampled command's
  double first_phase = 0;  ///< how far apart neighbouring neurons begin, in interspike intervals
};

/// One regularly spiking neuron a beam and the exponentially filtered readout, tick by tick.
class Controller {
 public:
  static constexpr TimeNs kTick = 1'000'000;

  Controller(Readout readout, double first_phase)
      : readout_(std::move(readout)),
        rate_hz_(kBeams, 0.0),
        phase_(kBeams, 0.0),
        trace_hz_(kBeams, 0.0) {
    for (std::size_t i = 0; i < kBeams; ++i) {
      phase_[i] = std::fmod(first_phase * static_cast<double>(i), 1.0);
    }
  }

  void see(const vehicle::LaserScan& scan) {
    constexpr double kRateMin = 1;
    constexpr double kRateMax = 200;
    for (std::size_t i = 0; i < kBeams; ++i) {
      const auto low = static_cast<double>(scan.range_min_m);
      const auto high = static_cast<double>(scan.range_max_m);
      const double range = std::clamp(static_cast<double>(scan.ranges_m[i]), low, high);
      const double x = 2 * (range - low) / (high - low) - 1;
      rate_hz_[i] = kRateMin + (x + 1) / 2 * (kRateMax - kRateMin);
    }
  }

  void tick() {
    constexpr double kTau_s = 0.03;  // of the readout
    const double dt = to_seconds(kTick);
    const double decay = std::exp(-dt / kTau_s);
    for (std::size_t i = 0; i < kBeams; ++i) {
      trace_hz_[i] *= decay;
      phase_[i] += rate_hz_[i] * dt;
      if (phase_[i] < 1) continue;
      phase_[i] -= 1;
      trace_hz_[i] += 1 / kTau_s;
    }
  }

  double command(std::size_t channel) const {
    const Readout::Channel& out = readout_.channels.at(channel);
    double sum = out.offset;
    for (std::size_t i = 0; i < kBeams; ++i) sum += out.weights[i] * trace_hz_[i];
    return std::clamp(sum, out.minimum, out.maximum);
  }

 private:
  Readout readout_;
  std::vector<double> rate_hz_;
  std::vector<double> phase_;  // of the next spike, in interspike intervals
  std::vector<double> trace_hz_;
};

/// 60 simulated seconds; a scan and a command every 50 ms.
inline vehicle::Statistics drive(const Readout& readout, const Drive& drive) {
  constexpr TimeNs kPeriod = 50'000'000;
  vehicle::Vehicle vehicle({"arena.xml", drive.seed});
  Controller controller(readout, drive.first_phase);
  struct Pending {
    TimeNs due;
    double linear, angular;
  };
  std::deque<Pending> pending;
  for (TimeNs t = 0; t < 60 * kNsPerSecond; t += Controller::kTick) {
    if (t % kPeriod == 0) {
      controller.see(vehicle.scan());
      pending.push_back({t + drive.delay, controller.command(0), controller.command(1)});
    }
    while (!pending.empty() && pending.front().due <= t) {
      vehicle.command(pending.front().linear, pending.front().angular);
      pending.pop_front();
    }
    controller.tick();
    vehicle.step(Controller::kTick);
  }
  return vehicle.statistics();
}

}  // namespace spikeloop::braitenberg
