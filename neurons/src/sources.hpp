// What drives a network from inside: Poisson spikes, and currents into membranes. Everything is a
// function of time and of random numbers that are keyed by (seed, NODE.POPULATION, member), so that
// no result depends on the tick.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "group.hpp"
#include "spikeloop/config/network_file.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop::neurons {

/// What keys the random numbers of a network.
struct Seeding {
  std::uint64_t seed = 1;
  std::string node{};

  RandomStream stream(const NetworkPopulation& population) const {
    return {seed, node + "." + population.name};
  }
};

/// Independent Poisson processes, one a member, with a rate that is constant between its steps.
/// Spike k comes where the rate's integral reaches the sum of k + 1 exponential numbers with
/// mean 1.
class PoissonTrains {
 public:
  PoissonTrains(const NetworkPopulation& population, const RandomStream& stream);

  /// `fire(member, time)` for the spikes up to `end` that have not been taken, by member and time.
  /// Times are rounded up.
  template <typename Fire>
  void advance(TimeNs end, Fire&& fire) {
    for (std::uint32_t member = 0; member < next_.size(); ++member) {
      for (; next_[member] <= end; draw(member)) {
        fire(member, next_[member]);
      }
    }
  }

 private:
  void draw(std::uint32_t member);
  TimeNs time_of(double integral) const;

  static constexpr TimeNs kNever = std::numeric_limits<TimeNs>::max();
  struct Piece {
    double begin_s;
    double integral;  // up to its begin
    double rate;      // Hz
  };
  const RandomStream stream_;
  std::vector<Piece> pieces_;
  std::vector<std::uint64_t> drawn_;
  std::vector<double> integral_;
  std::vector<TimeNs> next_;  // of each member; kNever: no more
};

/// The currents of one population. Step n is the interval ((n - 1) h, n h].
class CurrentSource {
 public:
  CurrentSource() = default;
  CurrentSource(const CurrentSource&) = delete;
  CurrentSource& operator=(const CurrentSource&) = delete;
  virtual ~CurrentSource() = default;

  /// Whether the values of `step` may differ from those of the step before.
  virtual bool changes(std::int64_t step) const = 0;
  /// The constant current that moves a membrane with tau_m (ms) over the step as the source's does,
  /// pA.
  virtual double value(std::uint32_t member, std::int64_t step, double tau_m) const = 0;
};

/// Every current, and where it flows.
class Currents {
 public:
  Currents(const NetworkFile& network, const Seeding& seeding);
  ~Currents();

  /// Values of port `signal` from now on.
  void set_signal(std::span<const double> values);
  /// Gives the groups what flows into them in this step; `groups` run parallel to the populations.
  void flow(std::int64_t step, std::span<const std::unique_ptr<Group>> groups);
  /// The values of a signal_input.
  std::span<const double> signal(std::size_t population) const { return signals_[population]; }
  /// Their sum.
  double total(std::size_t population) const;

 private:
  struct Inflow {
    std::size_t to;
    double tau_m;
    std::vector<const NetworkProjection*> projections;
  };
  std::vector<std::unique_ptr<CurrentSource>> sources_;  // by population; none for others
  std::vector<std::vector<double>> signals_;             // by population; empty for others
  std::vector<Inflow> inflows_;
  bool fresh_ = true;  // the signal has changed, or nothing has flown yet
};

}  // namespace spikeloop::neurons
