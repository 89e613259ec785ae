#include <cmath>

#include "base.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::environments {
namespace {

/// In alphabetical order.
constexpr std::unique_ptr<Environment> (*kMakers[])(const Options&) = {
    make_cart_pole, make_frozen_lake, make_mountain_car, make_water_maze};

}  // namespace

double checked_action(const Description& description, double action) {
  if (!std::isfinite(action)) {
    throw ConfigurationError(with_code(Code::not_a_number,
                                       "environment '{}': action {} is not a finite number; send a "
                                       "value from {} to {}",
                                       description.name, action, description.action[0].low,
                                       description.action[0].high));
  }
  if (description.actions == 0) {
    return action;
  }
  const double whole = std::round(action);
  if (whole < 0 || whole >= description.actions) {
    throw ConfigurationError(with_code(Code::out_of_bounds,
                                       "environment '{}': there is no action {}; send a whole "
                                       "number from 0 to {}",
                                       description.name, action, description.actions - 1));
  }
  return whole;
}

std::vector<Description> descriptions() {
  std::vector<Description> all;
  for (const auto& maker : kMakers) {
    all.push_back(maker({})->description());
  }
  return all;
}

std::unique_ptr<Environment> make(std::string_view name, const Options& options) {
  if (name.find(':') != std::string_view::npos || name.ends_with(".py")) {
    return make_script(std::string(name));
  }
  for (const auto& maker : kMakers) {
    auto environment = maker(options);
    if (environment->description().name == name) {
      environment->reset(0, 0);
      return environment;
    }
  }
  std::vector<std::string> names;
  for (const Description& description : descriptions()) {
    names.push_back(description.name);
  }
  throw ConfigurationError(with_code(Code::unknown_choice, "there is no environment '{}'{}", name,
                                     did_you_mean(name, names)));
}

}  // namespace spikeloop::environments
