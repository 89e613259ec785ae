// The lamps of a world, and the vehicle's two photodiodes.
#pragma once

#include <optional>
#include <vector>

#include "model.hpp"
#include "spikeloop/vehicle/sensors.hpp"

namespace spikeloop::vehicle {

class Photodiodes {
 public:
  /// @throws ConfigurationError: a lamp without intensity; a vehicle without diodes.
  Photodiodes(const mjModel& model, const Names& names);
  bool has_lamps() const { return !lamps_.empty(); }
  /// Positions in `data` must be those of now.
  Light read(const mjModel& model, const mjData& data, TimeNs stamp) const;

 private:
  struct Lamp {
    int site = -1;
    int body = -1;  // -1: part of the arena
    double intensity_cd = 0;
  };

  double illuminance(const mjModel& model, const mjData& data, int diode) const;

  std::vector<Lamp> lamps_;
  int left_ = -1;
  int right_ = -1;
};

}  // namespace spikeloop::vehicle
