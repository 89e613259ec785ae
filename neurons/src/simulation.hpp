// A network that advances over intervals: on the grid, or by events where there is no grid.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sources.hpp"
#include "spikeloop/config/network_file.hpp"
#include "spikeloop/core/signal.hpp"

namespace spikeloop::neurons {

inline double in_ms(TimeNs time) {
  return static_cast<double>(time) * 1e-6;
}

class Simulation {
 public:
  Simulation() = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  virtual ~Simulation() = default;

  /// Values of port `signal` from the next interval's begin on, which is `now`.
  virtual void set_signal(std::span<const double> values, TimeNs now) = 0;
  /// Advances over `interval`, which adjoins the last one; `input` is sorted by (time, channel).
  /// Appends the spikes of port `out` to output[0], and those of the recorded populations behind
  /// it, in the order of NetworkFile::record. A spike whose time plus delay has passed acts as
  /// early in the interval as it can.
  virtual void advance(Interval interval, std::span<const Spike> input,
                       std::vector<std::vector<Spike>>& output) = 0;
  /// At the end of the last interval: the membrane potential, mV, or the rate.
  virtual double value(std::size_t population, std::uint32_t member) const = 0;
  /// The weights of a learning projection at the end of the last interval; empty for another.
  virtual std::span<const double> learned(std::size_t projection) = 0;
  /// The same without computing: as they were when they were last brought up to date.
  virtual std::span<const double> learned_so_far(std::size_t projection) const = 0;
};

/// @param begin of its first interval
std::unique_ptr<Simulation> make_grid_simulation(const NetworkFile& network, const Seeding& seeding,
                                                 TimeNs begin = 0);
std::unique_ptr<Simulation> make_offgrid_simulation(const NetworkFile& network,
                                                    const Seeding& seeding);

/// Where the channels of the ports lie.
class ChannelMap {
 public:
  explicit ChannelMap(const NetworkFile& network);

  struct Member {
    std::size_t population = 0;
    std::uint32_t index = 0;
  };
  /// The member of an input population that a channel of port `in` is.
  Member input(std::int32_t channel) const;
  /// The first channel of a population on port `out`, -1 when it is not on it.
  std::int32_t output_base(std::size_t population) const { return output_base_[population]; }
  /// The list of recorded spikes that a population has, behind that of port `out`; 0: none.
  std::size_t recorded(std::size_t population) const { return recorded_[population]; }

 private:
  std::vector<std::uint32_t> input_end_;  // behind the last channel of each input population
  std::vector<std::size_t> input_population_;
  std::vector<std::int32_t> output_base_;
  std::vector<std::size_t> recorded_;
};

/// The projections that spikes of each population take, by its index: indices of projections.
std::vector<std::vector<std::size_t>> outgoing(const NetworkFile& network);

/// The synapses of source `index`.
inline std::span<const std::uint32_t> targets(const NetworkProjection& p, std::uint32_t index) {
  return std::span(p.target).subspan(p.row_start[index],
                                     p.row_start[index + 1] - p.row_start[index]);
}
inline std::span<const double> weights(const NetworkProjection& p, std::uint32_t index) {
  return std::span(p.weight).subspan(p.row_start[index],
                                     p.row_start[index + 1] - p.row_start[index]);
}

}  // namespace spikeloop::neurons
