#include "spikeloop/command/component_map.hpp"

#include <cmath>

namespace spikeloop::command {

std::vector<double> ComponentMap::deadbands(double fraction) const {
  std::vector<double> bands;
  for (const Component& component : components_) {
    const double limited = component.maximum - component.minimum;
    bands.push_back(fraction * (std::isfinite(limited) ? limited : 2 * std::fabs(component.scale)));
  }
  return bands;
}

std::vector<Bounds> ComponentMap::bounds() const {
  std::vector<Bounds> bounds;
  for (const Component& component : components_) {
    bounds.push_back({component.minimum, component.maximum, component.slew});
  }
  return bounds;
}

}  // namespace spikeloop::command
