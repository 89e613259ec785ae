#include "spikeloop/sensing/sensor_keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::sensing {
namespace {

using messages::NotANumber;
using messages::SensorField;
using Parameter = ParameterDescription;

constexpr double kMostDegrees = 360;
constexpr double kTurn = 2 * std::numbers::pi;

const std::vector<std::string> kPolicies = {"pass", "hold", "skip", "zero"};  // as NotANumber

Parameter number(const char* name, const char* value, const char* text) {
  return {.name = name, .default_value = value, .text = text};
}

Parameter field() {
  return {
      .name = "fields",
      .type = ParameterType::map,
      .inner = {{.name = "path", .type = ParameterType::text, .text = "Path of the field"},
                number("scale", "1", "Factor applied to the numbers"),
                number("offset", "0", "Added after the factor"),
                number("min", "", "Minimum of the channel"),
                number("max", "", "Maximum of the channel"),
                {.name = "range",
                 .type = ParameterType::list,
                 .default_value = "",
                 .text = "Values that are mapped to -1 and 1; replaces scale, offset, min and max",
                 .inner = {{.name = "end"}},
                 .count = 2,
                 .example = "[0, 4]"},
                {.name = "nan",
                 .type = ParameterType::text,
                 .default_value = "pass",
                 .text =
                     "How NaN is treated: pass, hold, skip, zero, or a number that replaces it"}},
      .plain_key = "path",
      .example = "[{path: ranges, scale: 2}]"};
}

/// @throws ConfigurationError if the first number is not below the second one
std::pair<double, double> read_range(const Parameters& keys, const char* key) {
  const double least = keys.numbers("range")[0];
  const double most = keys.numbers("range")[1];
  if (!(least < most)) {
    const std::string remedy = least > most ? fmt::format("[{}, {}]", most, least) : "[0, 4]";
    throw ConfigurationError(keys.where("range"),
                             with_code(Code::wrong_order,
                                       "key '{}': minimum {} is not below maximum {}; write  "
                                       "range: {}",
                                       key, least, most, remedy));
  }
  return {least, most};
}

/// [a, b] becomes [-1, 1].
void take_range(const Parameters& keys, SensorField& field) {
  for (const char* other : {"scale", "offset", "min", "max"}) {
    if (keys.given(other)) {
      throw ConfigurationError(
          keys.where("range"),
          with_code(Code::conflicting_keys,
                    "key 'fields': 'range' says what '{}' says; leave one of them out", other));
    }
  }
  const auto [least, most] = read_range(keys, "fields");
  field.scale = 2 / (most - least);
  field.offset = -(most + least) / (most - least);
  field.minimum = -1;
  field.maximum = 1;
}

void take_numbers(const Parameters& keys, SensorField& field) {
  field.scale = keys.number("scale");
  field.offset = keys.number("offset");
  field.minimum = keys.given("min") ? keys.number("min") : field.minimum;
  field.maximum = keys.given("max") ? keys.number("max") : field.maximum;
  if (field.minimum > field.maximum) {
    throw ConfigurationError(
        keys.where("min"),
        with_code(Code::wrong_order,
                  "key 'fields': 'min' is {} and 'max' is {}; write a minimum that is not above "
                  "the maximum",
                  field.minimum, field.maximum));
  }
}

void take_not_a_number(const Parameters& keys, SensorField& field) {
  const std::string& text = keys.text("nan");
  if (const auto word = std::ranges::find(kPolicies, text); word != kPolicies.end()) {
    field.not_a_number = static_cast<NotANumber>(word - kPolicies.begin());  // zero: a number, 0
    return;
  }
  try {
    field.instead = parse_quantity(text, "");
    field.not_a_number = NotANumber::number;
  } catch (const ConfigurationError&) {
    throw ConfigurationError(
        keys.where("nan"),
        with_code(Code::unknown_choice,
                  "key 'fields': 'nan' is '{}'{}; write one of: {}, or a number", text,
                  nearest(text, kPolicies).empty() ? "" : did_you_mean(text, kPolicies),
                  fmt::join(kPolicies, ", ")));
  }
}

SensorField field_of(const Parameters& keys) {
  SensorField field{.path = keys.text("path")};
  if (keys.given("range")) {
    take_range(keys, field);
  } else {
    take_numbers(keys, field);
  }
  take_not_a_number(keys, field);
  return field;
}

}  // namespace

std::vector<Parameter> sensor_parameters() {
  return {
      {.name = "fields",
       .type = ParameterType::list,
       .default_value = "",
       .text = "Fields to use instead of the default ones of the message type: paths, or maps "
               "of further keys",
       .inner = {field()},
       .example = "[pose.pose.position.x]"},
      {.name = "image",
       .type = ParameterType::map,
       .default_value = "",
       .text = "Conversion of a sensor_msgs/Image or CompressedImage (docs/images.md)",
       .inner = images::image_parameters(),
       .example = "{resize: [40, 30]}"},
      {.name = "beams",
       .type = ParameterType::integer,
       .default_value = "",
       .minimum = 1,
       .maximum = static_cast<double>(messages::kMostElements),
       .text = "Number of directions to which a sensor_msgs/LaserScan is resampled; not given: "
               "the beams of the message"},
      {.name = "angles",
       .type = ParameterType::list,
       .default_value = "",
       .text =
           "First and last direction of beams (deg), counterclockwise; not given: the first and "
           "last beam of each scan",
       .inner =
           {{.name = "angle", .unit = "deg", .minimum = -kMostDegrees, .maximum = kMostDegrees}},
       .count = 2,
       .example = "[-90 deg, 90 deg]"},
      {.name = "range",
       .type = ParameterType::list,
       .default_value = "",
       .text = "Distances of a sensor_msgs/LaserScan that are mapped to -1 and 1, in metres; not "
               "given: range_min and range_max of the message",
       .inner = {{.name = "end", .minimum = 0}},
       .count = 2,
       .example = "[0, 10]"}};
}

namespace {

/// @throws ConfigurationError for directions that are not counterclockwise, or without their number
messages::ScanRule scan_rule(const Parameters& keys) {
  messages::ScanRule rule;
  if (keys.given("beams")) {
    rule.beams = static_cast<std::uint32_t>(keys.integer("beams"));
  }
  if (keys.given("range")) {
    rule.range = read_range(keys, "range");
  }
  if (!keys.given("angles")) {
    return rule;
  }
  if (rule.beams == 0) {
    throw ConfigurationError(
        keys.where("angles"),
        with_code(Code::missing_key,
                  "key 'angles': key 'beams' with the number of directions is missing; write for "
                  "example  beams: 100"));
  }
  const double first = keys.numbers("angles")[0];
  const double last = keys.numbers("angles")[1];
  if (!(first < last)) {
    throw ConfigurationError(
        keys.where("angles"),
        with_code(
            Code::wrong_order,
            "key 'angles': {0:g} deg is not counterclockwise of {1:g} deg; write for example  "
            "angles: {2}",
            last, first,
            first == last ? std::string("[-90 deg, 90 deg]")
                          : fmt::format("[{0:g} deg, {1:g} deg]  or, across the back,  [{1:g} "
                                        "deg, {2:g} deg]",
                                        last, first, last + kMostDegrees)));
  }
  if (last - first > kMostDegrees) {
    throw ConfigurationError(
        keys.where("angles"),
        with_code(
            Code::out_of_bounds,
            "key 'angles': from {0:g} deg to {1:g} deg is more than {2:g} deg; write for example  "
            "angles: [{0:g} deg, {3:g} deg]",
            first, last, kMostDegrees, first + kMostDegrees));
  }
  rule.angles = {first / kMostDegrees * kTurn, last / kMostDegrees * kTurn};
  return rule;
}

}  // namespace

messages::SensorRule sensor_rule(const Parameters& keys) {
  messages::SensorRule rule;
  for (const Parameters::Entry& entry : keys.entries("fields")) {
    rule.fields.push_back(field_of(entry.values));
  }
  if (!keys.entries("image").empty()) {
    rule.image = images::image_settings(keys.map("image"));
  }
  if (rule.image && !rule.fields.empty()) {
    throw ConfigurationError(keys.where("image"),
                             with_code(Code::conflicting_keys,
                                       "key 'image': a picture and fields are not taken at once; "
                                       "leave 'image' or 'fields' out, "
                                       "and write a second sensor"));
  }
  for (const char* key : {"beams", "angles", "range"}) {
    if (!keys.given(key)) {
      continue;
    }
    if (rule.image || !rule.fields.empty()) {
      throw ConfigurationError(
          keys.where(key),
          with_code(Code::conflicting_keys,
                    "key '{}': it is for all beams of a sensor_msgs/LaserScan; leave it or '{}' "
                    "out",
                    key, rule.image ? "image" : "fields"));
    }
    rule.scan = scan_rule(keys);
  }
  return rule;
}

Location place_of_rule(const Parameters& keys) {
  for (const char* key : {"fields", "image", "beams", "angles", "range"}) {
    if (keys.given(key)) {
      return keys.where(key);
    }
  }
  return keys.where("message");
}

}  // namespace spikeloop::sensing
