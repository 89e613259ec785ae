// What a sensor takes of its messages, as experiments and mapping files write it.
//
//   fields: [pose.pose.position.x, {path: "ranges[0:100]", range: [0, 4], nan: hold}]
//   image: {crop: [0, 120, 640, 240], resize: [40, 30], filter: on_off}
#pragma once

#include "spikeloop/core/parameters.hpp"
#include "spikeloop/messages/sensor_rule.hpp"

namespace spikeloop::sensing {

/// @param fields JSON: a list of paths and of objects with path, scale, offset, min, max, range and
/// nan; or a path alone. Empty: not written.
/// @param image JSON: an object with the keys of images::image_parameters(). Empty: not written.
/// @throws ConfigurationError at the key's place with the value and what to write instead.
messages::SensorRule sensor_rule(const WrittenValue& fields, const WrittenValue& image);

}  // namespace spikeloop::sensing
