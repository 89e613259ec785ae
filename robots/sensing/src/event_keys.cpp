#include "spikeloop/sensing/event_keys.hpp"

#include <string_view>

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
           .text = "Events that are sent: all alike, those of brighter or of darker pixels, or "
                   "each on channels of their own"},
          {.name = "downsample",
           .type = ParameterType::integer,
           .default_value = "1",
           .minimum = 1,
           .maximum = kMostPixels,
           .text = "Blocks of so many by so many pixels share a channel"},
          {.name = "roi",
           .type = ParameterType::text,
           .default_value = "",
           .text = "Only this part of the camera, in pixels: x, y, width, height, as [100, 60, "
                   "128, 128] or 100,60,128,128"},
          {.name = "latency",
           .unit = "s",
           .default_value = "40 ms",
           .minimum = 0,
           .maximum = kLongest,
           .text = "How long after it happened an event is sent; at least as long as the driver "
                   "collects events for a message, and a tick"},
          {.name = "refractory",
           .unit = "s",
           .default_value = "0",
           .minimum = 0,
           .maximum = kLongest,
           .text = "Events of a channel so soon after its last one are left out"}};
}

messages::EventSettings event_settings(const Parameters& parameters,
                                       const std::string& message_type) {
  messages::EventSettings settings;
  settings.message_type = message_type;
  settings.polarity = messages::polarity_named(parameters.text("polarity"));
  settings.downsample = static_cast<std::uint32_t>(parameters.integer("downsample"));
  std::string_view roi = parameters.text("roi");
  if (roi.starts_with('[') && roi.ends_with(']')) {
    roi = roi.substr(1, roi.size() - 2);
  }
  if (!roi.empty() || parameters.given("roi")) {
    settings.region =
        located_at(parameters.where("roi"), [&] { return messages::parse_region(roi); });
  }
  settings.refractory = from_seconds(parameters.number("refractory"));
  return settings;
}

}  // namespace spikeloop::sensing
