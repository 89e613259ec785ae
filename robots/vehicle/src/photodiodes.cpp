#include "photodiodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr std::string_view kIntensity = "the lamp's luminous intensity (cd), above 0";
constexpr double kNearest = 1e-3;  // m; within a lamp it is as bright as here

}  // namespace

Photodiodes::Photodiodes(const mjModel& model, const Names& names) {
  for (int site = 0; site < model.nsite; ++site) {
    const std::string name = names.site(site);
    if (!name.starts_with("lamp_")) continue;
    const double intensity = names.required_numeric(name, 1, kIntensity)[0];
    if (!(intensity > 0)) {
      throw ConfigurationError(names.where(name),
                               with_code(Code::world, "numeric '{}' is \"{}\"; write 1 number: {}",
                                         name, intensity, kIntensity));
    }
    const int body = model.site_bodyid[site];
    lamps_.push_back({site, body > 0 ? body : -1, intensity});
  }
  if (lamps_.empty()) return;
  constexpr std::string_view kRemedy =
      "a world with lamps needs it: include the shipped vehicle, or write <site "
      "name=\"light_left\"/> and \"light_right\" into body 'vehicle', x along the diode's normal";
  left_ = names.find(mjOBJ_SITE, "site", "light_left", kRemedy);
  right_ = names.find(mjOBJ_SITE, "site", "light_right", kRemedy);
}

Light Photodiodes::read(const mjModel& model, const mjData& data, TimeNs stamp) const {
  return {stamp, illuminance(model, data, left_), illuminance(model, data, right_)};
}

double Photodiodes::illuminance(const mjModel& model, const mjData& data, int diode) const {
  const mjtNum* at = data.site_xpos + 3 * diode;
  const mjtNum* axes = data.site_xmat + 9 * diode;  // columns; the first is the normal
  double sum = 0;
  for (const Lamp& lamp : lamps_) {
    const mjtNum* source = data.site_xpos + 3 * lamp.site;
    mjtNum ray[3] = {source[0] - at[0], source[1] - at[1], source[2] - at[2]};
    const double distance = std::max(kNearest, mju_normalize3(ray));
    const double cosine = ray[0] * axes[0] + ray[1] * axes[3] + ray[2] * axes[6];
    if (cosine <= 0) continue;
    int hit = -1;
    const double free = mj_ray(&model, &data, at, ray, kAllButVehicle, 1, lamp.body, &hit);
    if (hit >= 0 && free < distance) continue;
    sum += lamp.intensity_cd * cosine / (distance * distance);
  }
  return sum;
}

}  // namespace spikeloop::vehicle
