#include "spikeloop/images/image_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "number_list.hpp"
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

ParameterDescription list(const char* name, const char* text) {
  return {.name = name, .type = ParameterType::text, .default_value = "", .text = text};
}

[[noreturn]] void refuse(const Parameters& parameters, const char* key, const std::string& what) {
  throw ConfigurationError(parameters.where(key),
                           fmt::format("key '{}': '{}' is {}", key, parameters.text(key), what));
}

/// `count` numbers; nothing when the key was not written.
std::optional<std::vector<double>> list_of(const Parameters& parameters, const char* key,
                                           std::size_t count, const std::string& what) {
  const std::string& text = parameters.text(key);
  if (text.empty()) {
    return std::nullopt;
  }
  auto numbers = numbers_of(text);
  if (!numbers || numbers->size() != count) {
    refuse(parameters, key, what);
  }
  return numbers;
}

std::optional<std::vector<std::uint32_t>> pixels_of(const Parameters& parameters, const char* key,
                                                    std::size_t count, const std::string& what) {
  const auto numbers = list_of(parameters, key, count, what);
  if (!numbers) {
    return std::nullopt;
  }
  std::vector<std::uint32_t> pixels;
  for (const double number : *numbers) {
    if (number < 0 || number > 1e6 || number != std::floor(number)) {
      refuse(parameters, key, what);
    }
    pixels.push_back(static_cast<std::uint32_t>(number));
  }
  return pixels;
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
      list("crop", "Only this part: [x, y, width, height] in pixels"),
      list("resize", "Averages of areas, so many: [width, height]; without it every pixel"),
      choice("channel", kChannels, "Which light: a plane of values, three for rgb"),
      list("range",
           "What becomes -1 and 1: [0, 255]; must be given for 32FC1 (metres) and 16UC1 "
           "(millimetres)"),
      choice("intensity", kIntensities, "log: equal ratios of light are equal steps"),
      choice("filter", kFilters,
             "centre_surround: contrast to the surround; on_off: its brighter part, then its "
             "darker one, in planes of their own"),
      {.name = "centre",
       .unit = "1",
       .default_value = "1",
       .minimum = 0.1,
       .maximum = 100,
       .text = "Standard deviation of the filter's centre, in pixels of the result"},
      {.name = "surround",
       .unit = "1",
       .default_value = "3",
       .minimum = 0.1,
       .maximum = 100,
       .text = "Standard deviation of its surround; above that of the centre"},
      {.name = "gain",
       .unit = "1",
       .default_value = "1",
       .minimum = 0,
       .maximum = 1000,
       .text = "Factor of the contrast before it is limited"},
  };
}

ImageSettings image_settings(const Parameters& parameters) {
  ImageSettings settings;
  const std::string crop_help =
      "no part of a picture; write [x, y, width, height] in pixels, as in [0, 120, 640, 240]";
  if (const auto crop = pixels_of(parameters, "crop", 4, crop_help)) {
    settings.crop = Crop{(*crop)[0], (*crop)[1], (*crop)[2], (*crop)[3]};
    if (settings.crop->width == 0 || settings.crop->height == 0) {
      refuse(parameters, "crop", crop_help);
    }
  }
  const std::string resize_help =
      fmt::format("no size; write [width, height] from 1 to {}, as in [40, 30]", kLongestSide);
  if (const auto size = pixels_of(parameters, "resize", 2, resize_help)) {
    settings.resize = Size{(*size)[0], (*size)[1]};
    const auto [least, most] = std::minmax((*size)[0], (*size)[1]);
    if (least == 0 || most > kLongestSide) {
      refuse(parameters, "resize", resize_help);
    }
  }
  const std::string range_help = "no least and greatest value; write for example [0, 255]";
  if (const auto range = list_of(parameters, "range", 2, range_help)) {
    settings.range = std::pair((*range)[0], (*range)[1]);
    if ((*range)[0] >= (*range)[1]) {
      refuse(parameters, "range", range_help);
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
        fmt::format("key 'surround': {} is not above centre, {}; write for example 3 times as much",
                    settings.surround, settings.centre));
  }
  return settings;
}

}  // namespace spikeloop::images
