#include "spikeloop/sensing/sensor_keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "spikeloop/core/error.hpp"

namespace spikeloop::sensing {
namespace {

using Json = nlohmann::ordered_json;
using messages::NotANumber;
using messages::SensorField;

const std::vector<std::string> kFieldKeys = {"path", "scale", "offset", "min",
                                             "max",  "range", "nan"};
constexpr const char* kExample = "fields: [pose.pose.position.x]";

class FieldsReader {
 public:
  explicit FieldsReader(const WrittenValue& written) : written_(written) {}

  std::vector<SensorField> read() {
    const std::string& text = written_.text;
    if (text.starts_with('{')) {
      fail(fmt::format("'{}' is no list; write  {}", text, kExample));
    }
    if (!text.starts_with('[')) {
      return {{.path = text}};
    }
    const Json list = Json::parse(text, nullptr, false);
    if (list.is_discarded()) {
      fail(fmt::format("'{}' is no list; write  {}", text, kExample));
    }
    std::vector<SensorField> fields;
    for (const Json& entry : list) {
      fields.push_back(field_of(entry));
    }
    return fields;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ConfigurationError(written_.where, fmt::format("key 'fields': {}", what));
  }
  [[noreturn]] void fail(const SensorField& field, const std::string& what) const {
    fail(fmt::format("'{}': {}", field.path, what));
  }

  SensorField field_of(const Json& entry) const {
    SensorField field;
    if (entry.is_string()) {
      field.path = entry.get<std::string>();
      return field;
    }
    if (!entry.is_object()) {
      fail(fmt::format("{} is no path of a field; write  {}", entry.dump(), kExample));
    }
    if (!entry.contains("path") || !entry["path"].is_string()) {
      fail(fmt::format("{} has no path of a field; write  fields: [{{path: ranges, scale: 2}}]",
                       entry.dump()));
    }
    field.path = entry["path"].get<std::string>();
    for (const auto& item : entry.items()) {
      if (std::ranges::find(kFieldKeys, item.key()) == kFieldKeys.end()) {
        fail(field,
             fmt::format("unknown key '{}'{}", item.key(), did_you_mean(item.key(), kFieldKeys)));
      }
    }
    take_range(entry, field);
    take_numbers(entry, field);
    take_not_a_number(entry, field);
    return field;
  }

  double number(const Json& entry, const char* key, const SensorField& field) const {
    const Json& value = entry[key];
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      fail(field, fmt::format("'{}' is {}, no finite number; write a number", key, value.dump()));
    }
    return value.get<double>();
  }

  void take_numbers(const Json& entry, SensorField& field) const {
    const std::pair<const char*, double*> numbers[] = {{"scale", &field.scale},
                                                       {"offset", &field.offset},
                                                       {"min", &field.minimum},
                                                       {"max", &field.maximum}};
    for (const auto& [key, value] : numbers) {
      if (!entry.contains(key)) {
        continue;
      }
      if (entry.contains("range")) {
        fail(field, fmt::format("'range' says what '{}' says; leave one of them out", key));
      }
      *value = number(entry, key, field);
    }
    if (field.minimum > field.maximum) {
      fail(field, fmt::format("'min' is {} and 'max' is {}; write a minimum that is not above the "
                              "maximum",
                              field.minimum, field.maximum));
    }
  }

  /// [a, b] becomes [-1, 1].
  void take_range(const Json& entry, SensorField& field) const {
    if (!entry.contains("range")) {
      return;
    }
    const Json& range = entry["range"];
    const auto is_number = [](const Json& value) { return value.is_number(); };
    if (!range.is_array() || range.size() != 2 || !std::ranges::all_of(range, is_number) ||
        !(range[0].get<double>() < range[1].get<double>())) {
      fail(field, fmt::format("'range' is {}, no least and greatest value; write  range: [0, 4]",
                              range.dump()));
    }
    const double least = range[0].get<double>();
    const double most = range[1].get<double>();
    field.scale = 2 / (most - least);
    field.offset = -(most + least) / (most - least);
    field.minimum = -1;
    field.maximum = 1;
  }

  void take_not_a_number(const Json& entry, SensorField& field) const {
    if (!entry.contains("nan")) {
      return;
    }
    const Json& value = entry["nan"];
    if (value.is_number()) {
      field.not_a_number = NotANumber::number;
      field.instead = number(entry, "nan", field);
      return;
    }
    const std::vector<std::string> words = {"pass", "hold", "skip", "zero"};
    const std::string word = value.is_string() ? value.get<std::string>() : value.dump();
    const auto found = std::ranges::find(words, word);
    if (found == words.end()) {
      fail(field, fmt::format("'nan' is '{}'{}; write one of: {}, or a number", word,
                              nearest(word, words).empty() ? "" : did_you_mean(word, words),
                              fmt::join(words, ", ")));
    }
    field.not_a_number = static_cast<NotANumber>(found - words.begin());  // zero: a number, 0
  }

  const WrittenValue& written_;
};

images::ImageSettings image_of(const WrittenValue& written) {
  const auto fail = [&](const std::string& what) {
    throw ConfigurationError(written.where, fmt::format("key 'image': {}", what));
  };
  const Json map = Json::parse(written.text, nullptr, false);
  if (map.is_discarded() || !map.is_object()) {
    fail(fmt::format("'{}' is no map; write  image: {{resize: [40, 30]}}", written.text));
  }
  WrittenValues keys;
  for (const auto& item : map.items()) {
    const Json& value = item.value();
    keys[item.key()] = {value.is_string() ? value.get<std::string>() : value.dump(), {}};
  }
  images::ImageSettings settings;
  try {
    settings = images::image_settings(resolve(images::image_parameters(), keys, {}));
  } catch (const ConfigurationError& error) {
    fail(error.what());
  }
  return settings;
}

}  // namespace

messages::SensorRule sensor_rule(const WrittenValue& fields, const WrittenValue& image) {
  messages::SensorRule rule;
  if (!fields.text.empty()) {
    rule.fields = FieldsReader(fields).read();
  }
  if (!image.text.empty()) {
    rule.image = image_of(image);
  }
  if (rule.image && !rule.fields.empty()) {
    throw ConfigurationError(
        image.where,
        "key 'image': a picture and fields are not taken at once; leave 'image' or "
        "'fields' out, and write a second sensor");
  }
  return rule;
}

}  // namespace spikeloop::sensing
