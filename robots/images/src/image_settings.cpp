#include "spikeloop/images/image_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::images {
namespace {

constexpr const char* kChannels[] = {"grey", "red", "green", "blue", "rgb"};
constexpr const char* kIntensities[] = {"linear", "log"};
constexpr const char* kFilters[] = {"none", "centre_surround", "on_off"};

template <typename Choice, std::size_t Count>
Choice choice_of(const Parameters& parameters, const char* key, const char* const (&names)[Count]) {
  const auto* const found = std::find(std::begin(names), std::end(names), parameters.text(key));
  return static_cast<Choice>(found - std::begin(names));
}

template <std::size_t Count>
ParameterDescription choice(const char* name, const char* const (&names)[Count], const char* text) {
  return {.name = name,
          .type = ParameterType::choice,
          .default_value = names[0],
          .choices = {std::begin(names), std::end(names)},
          .text = text};
}

/// [0, 120, 640, 240]
ParameterDescription pixels(const char* name, std::size_t count, double least, double most,
                            const char* text, const char* example) {
  return {.name = name,
          .type = ParameterType::list,
          .default_value = "",
          .text = text,
          .inner = {{.name = "pixels",
                     .type = ParameterType::integer,
                     .minimum = least,
                     .maximum = most}},
          .count = count,
          .example = example};
}

std::uint32_t whole(double number) {
  return static_cast<std::uint32_t>(number);
}

}  // namespace

std::optional<std::uint32_t> ImageSettings::values() const {
  if (resize) {
    return planes() * resize->width * resize->height;
  }
  if (crop) {
    return planes() * crop->width * crop->height;
  }
  return std::nullopt;
}

std::vector<ParameterDescription> image_parameters() {
  return {
      pixels("crop", 4, 0, 1e6, "Region of the image to use: [x, y, width, height] in pixels",
             "[0, 120, 640, 240]"),
      pixels("resize", 2, 1, kLongestSide,
             "Size of the result, by area averaging: [width, height]; not given: every pixel",
             "[40, 30]"),
      choice("channel", kChannels, "Colour channel: one plane of values, or three for rgb"),
      {.name = "range",
       .type = ParameterType::list,
       .default_value = "",
       .text = "Values that are mapped to -1 and 1, e.g. [0, 255]; required for 32FC1 (metres), "
               "16UC1 (millimetres) and types with a sign",
       .inner = {{.name = "end"}},
       .count = 2,
       .example = "[0, 255]"},
      choice("intensity", kIntensities, "log: equal ratios of intensity become equal steps"),
      choice("filter", kFilters,
             "centre_surround: contrast between centre and surround; on_off: its positive and its "
             "negative part, in separate planes"),
      {.name = "centre",
       .unit = "1",
       .default_value = "1",
       .minimum = 0.1,
       .maximum = 100,
       .text = "Standard deviation of the filter centre, in pixels of the result"},
      {.name = "surround",
       .unit = "1",
       .default_value = "3",
       .minimum = 0.1,
       .maximum = 100,
       .text = "Standard deviation of the filter surround; larger than centre"},
      {.name = "gain",
       .unit = "1",
       .default_value = "1",
       .minimum = 0,
       .maximum = 1000,
       .text = "Factor applied to the contrast before it is clipped"},
  };
}

ImageSettings image_settings(const Parameters& parameters) {
  ImageSettings settings;
  if (const auto& crop = parameters.numbers("crop"); !crop.empty()) {
    settings.crop = Crop{whole(crop[0]), whole(crop[1]), whole(crop[2]), whole(crop[3])};
    if (settings.crop->width == 0 || settings.crop->height == 0) {
      throw ConfigurationError(
          parameters.where("crop"),
          with_code(Code::out_of_bounds,
                    "key 'crop': a part without pixels; write [x, y, width, height], as "
                    "in [0, 120, 640, 240]"));
    }
  }
  if (const auto& size = parameters.numbers("resize"); !size.empty()) {
    settings.resize = Size{whole(size[0]), whole(size[1])};
  }
  if (const auto& range = parameters.numbers("range"); !range.empty()) {
    settings.range = std::pair(range[0], range[1]);
    if (range[0] >= range[1]) {
      throw ConfigurationError(
          parameters.where("range"),
          with_code(
              Code::wrong_order,
              "key 'range': minimum {} is not below maximum {}; write  range: {}", range[0],
              range[1],
              range[0] > range[1] ? fmt::format("[{}, {}]", range[1], range[0]) : "[0, 255]"));
    }
  }
  settings.channel = choice_of<Channel>(parameters, "channel", kChannels);
  settings.intensity = choice_of<Intensity>(parameters, "intensity", kIntensities);
  settings.filter = choice_of<Filter>(parameters, "filter", kFilters);
  settings.centre = parameters.number("centre");
  settings.surround = parameters.number("surround");
  settings.gain = parameters.number("gain");
  if (settings.filter != Filter::none && settings.surround <= settings.centre) {
    throw ConfigurationError(
        parameters.where(parameters.given("surround") ? "surround" : "centre"),
        with_code(Code::wrong_order,
                  "key 'surround': {} is not above centre, {}; write for example 3 times as much",
                  settings.surround, settings.centre));
  }
  return settings;
}

}  // namespace spikeloop::images
