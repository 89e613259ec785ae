// The neurons of a NEF encoder: leaky integrate-and-fire, under a piecewise constant input, solved
// in closed form. Between an input's change and a spike nothing is computed, so that no spike
// depends on ticks, and the cost is one a spike and one a change.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "large_array.hpp"
#include "nef_kernels.hpp"
#include "spikeloop/core/signal.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop {

class NefPopulation {
 public:
  NefPopulation(const NefModel& model, std::uint32_t neurons, std::uint32_t dimensions);
  NefPopulation(const NefPopulation&) = delete;
  NefPopulation& operator=(const NefPopulation&) = delete;

  /// Neuron n keeps `potential` until the first input comes, and gets the current
  /// bias + gain * (direction . x)  from input x, counted from the current that holds it at the
  /// threshold.
  void set_neuron(std::uint32_t n, double gain, double bias, double potential,
                  std::span<const double> direction);

  /// From `now` on the input is x, or, with `rest`, there is none and no leak either. Spikes up to
  /// `now` have been taken.
  void set_input(TimeNs now, std::span<const double> x);
  void rest(TimeNs now);

  /// Appends the spikes up to `end`; neuron n is channel first_channel + n.
  void advance(TimeNs end, std::uint32_t first_channel, std::vector<Spike>& spikes);

 private:
  // Times count from a new zero after about a second, lest they lose their precision.
  static constexpr TimeNs kLongest = TimeNs{1} << 30;

  void change(TimeNs now);
  void fire(TimeNs end, std::uint32_t first_channel, std::vector<Spike>& spikes);
  void take_committed(TimeNs end, std::uint32_t first_channel, std::vector<Spike>& spikes);
  void take_fired(std::uint32_t first_channel, std::vector<Spike>& spikes) const;
  TimeNs since_grid() const { return grid_ == 0 ? 0 : since_ % grid_; }

  NefModel model_;
  TimeNs grid_;
  std::size_t dimensions_;
  LargeArray<NefFast> fast_;
  LargeArray<NefSlow> slow_;
  LargeArray<float> earliest_;
  LargeArray<float> directions_;
  std::vector<double> input_;
  bool has_input_ = false;
  TimeNs since_ = 0;  // the latest change
  std::vector<std::uint32_t> committed_;
  TimeNs committed_at_ = 0;
  std::vector<std::uint32_t> due_;
  NefFiring firing_;
};

}  // namespace spikeloop
