#include "spikeloop/config/mapping_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "json_text.hpp"
#include "music_text.hpp"
#include "spikeloop/config/data_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/log.hpp"

namespace spikeloop {

namespace {

using Json = nlohmann::ordered_json;
using json_text::shown_json;

constexpr const char* kArray = "std_msgs/Float64MultiArray";
constexpr const char* kExample =
    "{\"message_type\": \"Twist\", \"mapping\": {\"linear.x\": 0, \"angular.z\": 1}}";

/// "data[2:5]" in its parts.
struct Slice {
  std::string array;
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

std::optional<Slice> slice_of(std::string_view field) {
  const auto bracket = field.rfind('[');
  const auto colon = field.rfind(':');
  if (!field.ends_with(']') || bracket == std::string_view::npos || colon < bracket ||
      colon == std::string_view::npos) {
    return std::nullopt;
  }
  Slice slice{std::string(field.substr(0, bracket))};
  const auto read = [](std::string_view digits, std::uint32_t& value) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc{} && end == digits.data() + digits.size();
  };
  const bool good = read(field.substr(bracket + 1, colon - bracket - 1), slice.first) &&
                    read(field.substr(colon + 1, field.size() - colon - 2), slice.last);
  return good ? std::optional(slice) : std::nullopt;
}

class MappingReader {
 public:
  MappingReader(const Json& json, std::string_view text, const std::string& file,
                const MappingOptions& options)
      : json_(json),
        text_(text),
        base_(file.empty() ? options.base_directory : std::filesystem::path(file).parent_path()),
        strict_(options.strict) {
    mapping_.file = file;
  }

  CommandMapping read() {
    if (!json_.is_object()) {
      fail(with_code(Code::wrong_shape, "the file holds {}, no object; write {}", shown_json(json_),
                     kExample));
    }
    check_keys(json_, {"message_type", "mapping", "min", "max", "stop"}, {});
    read_message_type();
    read_limits(json_, {}, minimum_, maximum_);
    read_stop(json_, {}, mapping_.stop);
    if (mapping_.stop && (mapping_.stop->value != 0 || !mapping_.stop->joint.empty())) {
      fail(with_code(Code::unknown_choice,
                     "'stop' of the file is {}; write \"zero\" or \"hold\", or 'stop' with a "
                     "number in a field",
                     shown_json(json_["stop"])),
           {"stop"});
    }
    if (json_.contains("mapping")) {
      read_fields(json_["mapping"]);
    } else if (mapping_.message_type == kArray) {
      read_all_channels();
    } else {
      complain(with_code(Code::missing_key, "'mapping' is missing; write {}", kExample),
               "every field is 0");
    }
    return std::move(mapping_);
  }

 private:
  /// Of a key and those that it stands in.
  using Path = std::vector<std::string>;

  static Path below(Path path, const std::string& key) {
    path.push_back(key);
    return path;
  }
  static std::string name_of(const Path& path) {
    return music_text::shown(fmt::format("{}", fmt::join(path, ".")));
  }
  Location where(const Path& path) const {
    return json_text::locate_key(text_, path, mapping_.file);
  }

  [[noreturn]] void fail(const std::string& message, const Path& path = {}) const {
    throw ConfigurationError(where(path), message);
  }
  /// An error when strict, else a warning that says what is done.
  void complain(const std::string& message, const std::string& consequence,
                const Path& path = {}) const {
    if (strict_) {
      fail(message, path);
    }
    log::warning("{}: {}", where(path).text(), lengthened(message, "; " + consequence));
  }

  void check_keys(const Json& object, const std::vector<std::string>& known, const Path& of) const {
    for (const auto& item : object.items()) {
      if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
        const Path path = below(of, item.key());
        complain(with_code(Code::unknown_key, "unknown key '{}'{}", name_of(path),
                           did_you_mean(item.key(), known)),
                 "it is ignored", path);
      }
    }
  }

  void read_message_type() {
    if (!json_.contains("message_type")) {
      fail(with_code(Code::missing_key, "'message_type' is missing; write {}", kExample));
    }
    const Json& type = json_["message_type"];
    if (!type.is_string()) {
      fail(with_code(Code::wrong_shape, "'message_type' is {}, no text; write {}", shown_json(type),
                     kExample),
           {"message_type"});
    }
    try {
      mapping_.message_type = canonical_message_type(type.get<std::string>(), base_);
    } catch (const ConfigurationError& error) {
      fail(fmt::format("'message_type': {}", error.what()), {"message_type"});
    }
  }

  double number(const Json& object, const std::string& key, const Path& of) const {
    const Json& value = object[key];
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      const Path path = below(of, key);
      fail(with_code(Code::not_a_number, "'{}' is {}, no finite number; write a number",
                     name_of(path), shown_json(value)),
           path);
    }
    return value.get<double>();
  }

  void read_limits(const Json& object, const Path& of, std::optional<double>& minimum,
                   std::optional<double>& maximum) const {
    if (object.contains("min")) {
      minimum = number(object, "min", of);
    }
    if (object.contains("max")) {
      maximum = number(object, "max", of);
    }
    if (minimum && maximum && *minimum > *maximum) {
      fail(with_code(Code::wrong_order,
                     "'{}' is {} and '{}' is {}; write a minimum that is not above the maximum",
                     name_of(below(of, "min")), *minimum, name_of(below(of, "max")), *maximum),
           below(of, object.contains("max") ? "max" : "min"));
    }
  }

  void read_slew(const Json& object, const Path& of, std::optional<double>& slew) const {
    if (!object.contains("slew")) {
      return;
    }
    slew = number(object, "slew", of);
    if (*slew <= 0) {
      fail(with_code(Code::out_of_bounds,
                     "'{}' is {}, no rate of change; write a number above 0, or leave it out",
                     name_of(below(of, "slew")), *slew),
           below(of, "slew"));
    }
  }

  void read_stop(const Json& object, const Path& of, std::optional<StopRule>& stop) const {
    if (!object.contains("stop")) {
      return;
    }
    const Json& value = object["stop"];
    const Path path = below(of, "stop");
    try {
      stop = parse_stop(value.is_string() ? value.get<std::string>() : value.dump());
    } catch (const ConfigurationError& error) {
      fail(fmt::format("'{}': {}", name_of(path), error.what()), path);
    }
  }

  void read_all_channels() {
    mapping_.all_channels = true;
    if (minimum_ || maximum_) {
      complain(
          with_code(Code::conflicting_keys,
                    "'min' and 'max' do not hold for a Float64MultiArray without "
                    "mapping; remove them, or map every element: {\"mapping\": {\"data[0]\": 0}}"),
          "they are ignored", {minimum_ ? "min" : "max"});
    }
  }

  void read_fields(const Json& fields) {
    if (!fields.is_object()) {
      fail(with_code(Code::wrong_shape, "'mapping' is {}, no object; write {}", shown_json(fields),
                     kExample),
           {"mapping"});
    }
    if (mapping_.message_type == kArray && !strict_) {
      complain(with_code(Code::conflicting_keys,
                         "'mapping' does not hold for a Float64MultiArray; remove it"),
               "all channels are sent", {"mapping"});
      mapping_.all_channels = true;
      return;
    }
    if (fields.empty()) {
      complain(with_code(Code::wrong_shape, "'mapping' is empty; write {}", kExample),
               "every field is 0", {"mapping"});
    }
    for (const auto& item : fields.items()) {
      read_field(item.key(), item.value());
    }
    if (minimum_ == 0.0 && maximum_ == 0.0) {
      log::warning("{}: 'min' and 'max' are both 0; every field is 0", where({"max"}).text());
    }
  }

  void read_field(const std::string& name, const Json& value) {
    const Path path{"mapping", name};
    CommandField field{.field = name, .where = where(path)};
    field.minimum = minimum_;
    field.maximum = maximum_;
    field.stop = mapping_.stop;
    if (!value.is_object()) {
      if (const auto channel = read_channel(value, path)) {
        field.channel = *channel;
        add(field, path);
      }
      return;
    }
    check_keys(value, {"channel", "scale", "offset", "min", "max", "slew", "stop"}, path);
    if (!value.contains("channel")) {
      fail(with_code(Code::missing_key, "'{}' has no channel; write {{\"channel\": 0}}",
                     name_of(path)),
           path);
    }
    field.scale = value.contains("scale") ? number(value, "scale", path) : 1.0;
    field.offset = value.contains("offset") ? number(value, "offset", path) : 0.0;
    read_limits(value, path, field.minimum, field.maximum);
    read_slew(value, path, field.slew);
    read_stop(value, path, field.stop);
    if (const auto channel = read_channel(value["channel"], below(path, "channel"))) {
      field.channel = *channel;
      add(field, path);
    }
  }

  /// A field, or the elements that its slice names.
  void add(const CommandField& field, const Path& path) {
    constexpr std::uint32_t kMostElements = 100'000;
    const auto slice = slice_of(field.field);
    if (!slice) {
      mapping_.fields.push_back(field);
      return;
    }
    if (slice->last <= slice->first || slice->last - slice->first > kMostElements) {
      fail(with_code(Code::field_path,
                     "'{}' names no elements, or more than {}; write the first one and the one "
                     "behind the last, as in data[0:3]",
                     name_of(path), kMostElements),
           path);
    }
    for (std::uint32_t i = slice->first; i < slice->last; ++i) {
      CommandField element = field;
      element.field = fmt::format("{}[{}]", slice->array, i);
      element.channel += i - slice->first;
      mapping_.fields.push_back(element);
    }
  }

  std::optional<std::uint32_t> read_channel(const Json& value, const Path& path) const {
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (number == -1.0) {
      complain(
          with_code(Code::fields_differ, "'{}' is -1, no channel; remove the field", name_of(path)),
          "the field is 0", path);
      return std::nullopt;
    }
    if (!(number >= 0 && number <= 2147483647.0 && number == std::floor(number))) {
      fail(with_code(Code::fields_differ, "'{}' is {}, no channel; write a whole number from 0",
                     name_of(path), shown_json(value)),
           path);
    }
    return static_cast<std::uint32_t>(number);
  }

  const Json& json_;
  std::string_view text_;
  std::filesystem::path base_;
  bool strict_;
  CommandMapping mapping_;
  std::optional<double> minimum_;
  std::optional<double> maximum_;
};

CommandMapping array_instead(const std::string& file, const std::string& reason,
                             const MappingOptions& options) {
  log::warning("{}", lengthened(ConfigurationError(options.named_in, reason).what(),
                                "; all channels are sent as a Float64MultiArray"));
  return {file, kArray, true};
}

}  // namespace

StopRule parse_stop(std::string_view text) {
  constexpr std::string_view kHold = "hold";
  if (text == kHold) {
    return {.hold = true};
  }
  if (text.starts_with("hold ")) {
    const std::string_view joint = text.substr(kHold.size() + 1);
    return {.hold = true, .joint = std::string(joint)};
  }
  if (text == "zero") {
    return {};
  }
  StopRule rule;
  const char* const end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, rule.value);
  if (error != std::errc{} || read != end || !std::isfinite(rule.value)) {
    throw ConfigurationError(
        with_code(Code::not_a_number,
                  "{} is no value for a stop; write a number, or hold, or hold and the name of a "
                  "joint",
                  music_text::shown(text)));
  }
  return rule;
}

std::string stop_text(const StopRule& rule) {
  if (!rule.hold) {
    return fmt::to_string(rule.value);
  }
  return rule.joint.empty() ? "hold" : "hold " + rule.joint;
}

CommandMapping parse_mapping(std::string_view text, const std::string& file,
                             const MappingOptions& options) {
  Json json;
  try {
    json = json_text::parse(text, file);
  } catch (const ConfigurationError& error) {
    if (options.strict) {
      throw;
    }
    return array_instead(file, error.what(), options);
  }
  return MappingReader(json, text, file, options).read();
}

CommandMapping read_mapping(const std::string& name, const MappingOptions& options) {
  const auto path = find_data_file(name, options.base_directory);
  if (!path) {
    const std::string message =
        with_code(Code::missing_file, "there is no mapping file '{}' in {}; write its path",
                  music_text::shown(name), data_file_places(options.base_directory));
    if (options.strict) {
      throw ConfigurationError(message);
    }
    return array_instead(name, message, options);
  }
  constexpr std::uint64_t kLimit = 16'000'000;
  std::string text;
  try {
    text = read_file(*path, "mapping file", kLimit);
  } catch (const FileError& error) {
    if (options.strict) {
      throw;
    }
    return array_instead(name, error.what(), options);
  }
  return parse_mapping(text, path->string(), options);
}

void check_channels(const CommandMapping& mapping, std::uint32_t width) {
  for (const auto& field : mapping.fields) {
    if (field.channel >= width) {
      throw ConfigurationError(
          field.where,
          with_code(Code::fields_differ,
                    "'mapping.{}' reads channel {}, but the port has {} (0 to {}); write one of "
                    "these or widen the connection",
                    music_text::shown(field.field), field.channel, width,
                    width == 0 ? 0 : width - 1));
    }
  }
}

}  // namespace spikeloop
