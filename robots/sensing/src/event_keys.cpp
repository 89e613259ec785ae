#include "spikeloop/sensing/event_keys.hpp"

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::sensing {
namespace {

constexpr double kMostPixels = 65536;
constexpr double kLongest = 60;  // s

}  // namespace

std::vector<ParameterDescription> event_parameters() {
  return {{.name = "polarity",
           .type = ParameterType::choice,
           .default_value = "both",
           .choices = {"both", "on", "off", "split"},
           .text = "Events to send. both: all, without distinction; on: brighter pixels; off: "
                   "darker pixels; split: on and off in separate channels"},
          {.name = "downsample",
           .type = ParameterType::integer,
           .default_value = "1",
           .minimum = 1,
           .maximum = kMostPixels,
           .text = "Side length in pixels of the square blocks that share a channel"},
          {.name = "roi",
           .type = ParameterType::list,
           .default_value = "",
           .text = "Region of the camera image to use, in pixels: x, y, width, height",
           .inner = {{.name = "pixel",
                      .type = ParameterType::integer,
                      .minimum = 0,
                      .maximum = kMostPixels}},
           .count = 4,
           .example = "[100, 60, 128, 128]"},
          {.name = "latency",
           .unit = "s",
           .default_value = "40 ms",
           .minimum = 0,
           .maximum = kLongest,
           .text = "Delay from an event to its spike; at least the time for which the driver "
                   "collects events for a message, plus a tick"},
          {.name = "refractory",
           .unit = "s",
           .default_value = "0",
           .minimum = 0,
           .maximum = kLongest,
           .text = "Time after an event during which further events of the channel are dropped"}};
}

messages::EventSettings event_settings(const Parameters& parameters,
                                       const std::string& message_type) {
  messages::EventSettings settings;
  settings.message_type = message_type;
  settings.polarity = messages::polarity_named(parameters.text("polarity"));
  settings.downsample = static_cast<std::uint32_t>(parameters.integer("downsample"));
  if (const auto& roi = parameters.numbers("roi"); !roi.empty()) {
    settings.region =
        messages::Region{static_cast<std::uint32_t>(roi[0]), static_cast<std::uint32_t>(roi[1]),
                         static_cast<std::uint32_t>(roi[2]), static_cast<std::uint32_t>(roi[3])};
    if (settings.region->width == 0 || settings.region->height == 0) {
      throw ConfigurationError(
          parameters.where("roi"),
          with_code(
              Code::out_of_bounds,
              "key 'roi': a region without pixels; write its left upper corner and its size, as in "
              "[100, 60, 128, 128]"));
    }
  }
  settings.refractory = from_seconds(parameters.number("refractory"));
  return settings;
}

}  // namespace spikeloop::sensing
