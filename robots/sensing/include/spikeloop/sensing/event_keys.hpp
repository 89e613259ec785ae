// What is taken of an event camera, as experiments and .music files write it.
//
//   polarity: split, downsample: 4, roi: [100, 60, 128, 128], latency: 40 ms, refractory: 1 ms
#pragma once

#include <string>
#include <vector>

#include "spikeloop/core/parameters.hpp"
#include "spikeloop/messages/event_conversion.hpp"

namespace spikeloop::sensing {

/// polarity, downsample, roi, latency, refractory.
std::vector<ParameterDescription> event_parameters();

/// All of them but `latency`, with a message's type. @throws ConfigurationError at `roi` when it is
/// empty.
messages::EventSettings event_settings(const Parameters& parameters,
                                       const std::string& message_type);

}  // namespace spikeloop::sensing
