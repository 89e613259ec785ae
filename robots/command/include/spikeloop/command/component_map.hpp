// From a port's channels to the components of a command.
#pragma once

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "spikeloop/command/limiter.hpp"

namespace spikeloop::command {

/// value = limit(scale * channel + offset); NaN stays NaN
struct Component {
  std::uint32_t channel = 0;
  double scale = 1;
  double offset = 0;
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  double slew = std::numeric_limits<double>::infinity();  ///< a second; not applied here
};

class ComponentMap {
 public:
  explicit ComponentMap(std::vector<Component> components) : components_(std::move(components)) {}

  const std::vector<Component>& components() const { return components_; }
  /// `fraction` of each component's range: its limits, or without them what a channel in [-1, 1]
  /// gives.
  std::vector<double> deadbands(double fraction) const;
  /// What a Limiter wants.
  std::vector<Bounds> bounds() const;
  std::size_t size() const { return components_.size(); }

 private:
  std::vector<Component> components_;
};

}  // namespace spikeloop::command
