// Spikes as arrays of NumPy.
#pragma once

#include <pybind11/numpy.h>

#include <span>

#include "spikeloop/core/node.hpp"

namespace spikeloop::python {

/// (times in ns, int64; channels, int32)
inline pybind11::tuple spike_arrays(std::span<const Spike> spikes) {
  const auto count = static_cast<pybind11::ssize_t>(spikes.size());
  pybind11::array_t<std::int64_t> times(count);
  pybind11::array_t<std::int32_t> channels(count);
  auto* time = times.mutable_data();
  auto* channel = channels.mutable_data();
  for (const Spike& spike : spikes) {
    *time++ = spike.time_ns;
    *channel++ = spike.channel;
  }
  return pybind11::make_tuple(times, channels);
}

}  // namespace spikeloop::python
