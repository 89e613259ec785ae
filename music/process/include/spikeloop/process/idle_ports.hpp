// What stands in for a MUSIC port that is not there.
#pragma once

#include <memory>

#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::music {

/// Never a value, never a spike.
std::unique_ptr<Source> make_idle_source(const EndpointPort& port);
/// Takes whatever comes.
std::unique_ptr<Sink> make_idle_sink(const EndpointPort& port);

}  // namespace spikeloop::music
