#include "spikeloop/process/initial_key.hpp"

#include <fmt/format.h>

namespace spikeloop::music {

ParameterDescription initial_parameter() {
  return {.name = "initial",
          .type = ParameterType::text,
          .default_value = "none",
          .text = "Value of every channel before the first message; none: no value"};
}

std::optional<double> initial_value(const Parameters& parameters) {
  const std::string& text = parameters.text("initial");
  if (text == "none") {
    return std::nullopt;
  }
  try {
    return parse_quantity(text, "1");
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(parameters.where("initial"),
                             fmt::format("initial: {}; or write initial=none", error.what()));
  }
}

}  // namespace spikeloop::music
