// What a sensor takes of its messages, as experiments and mapping files write it.
//
//   fields: [pose.pose.position.x, {path: "ranges[0:100]", range: [0, 4], nan: hold}]
//   image: {crop: [0, 120, 640, 240], resize: [40, 30], filter: on_off}
//   beams: 100, angles: [-90 deg, 90 deg], range: [0, 10]
#pragma once

#include <vector>

#include "spikeloop/core/parameters.hpp"
#include "spikeloop/messages/sensor_rule.hpp"

namespace spikeloop::sensing {

/// fields, image, beams, angles, range.
std::vector<ParameterDescription> sensor_parameters();

/// @throws ConfigurationError at the value's place with what to write instead.
messages::SensorRule sensor_rule(const Parameters& keys);

/// Place of the key that determines the values of a sensor with these keys and `message`.
Location place_of_rule(const Parameters& keys);

}  // namespace spikeloop::sensing
