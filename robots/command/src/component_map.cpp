#include "spikeloop/command/component_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spikeloop::command {

ComponentMap::ComponentMap(std::vector<Component> components)
    : components_(std::move(components)), values_(components_.size()) {}

std::span<const double> ComponentMap::map(std::span<const double> channels) {
  for (std::size_t i = 0; i < components_.size(); ++i) {
    const Component& component = components_[i];
    const double channel = channels[component.channel];
    // An infinite channel is a fault, which limits must not hide.
    values_[i] = std::isfinite(channel) ? std::clamp(component.scale * channel + component.offset,
                                                     component.minimum, component.maximum)
                                        : channel;
  }
  return values_;
}

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
