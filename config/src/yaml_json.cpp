#include "yaml_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/core/code.hpp"
#include "yaml_section.hpp"

namespace spikeloop::yaml_text {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDeepest = 32;
constexpr std::size_t kMostValues = 4'000'000;

class Converter {
 public:
  explicit Converter(const std::string& file) : file_(file) {}

  Json convert(const YAML::Node& node, int depth) {
    if (depth > kDeepest || ++values_ > kMostValues) {
      throw ConfigurationError(
          place(file_, node),
          with_code(Code::out_of_bounds,
                    "there are more than {} values or {} levels here; write them into a file",
                    kMostValues, kDeepest));
    }
    if (node.IsSequence()) {
      Json list = Json::array();
      for (const auto& item : node) {
        list.push_back(convert(item, depth + 1));
      }
      return list;
    }
    return node.IsMap() ? map(node, depth) : value(node);
  }

 private:
  Json map(const YAML::Node& node, int depth) {
    Json object = Json::object();
    for (const auto& entry : node) {
      const std::string key = scalar(file_, "key", entry.first);
      if (object.contains(key)) {
        throw ConfigurationError(place(file_, entry.first),
                                 with_code(Code::duplicate_key, "duplicate key '{}'", key));
      }
      object[key] = convert(entry.second, depth + 1);
    }
    return object;
  }

  static Json value(const YAML::Node& node) {
    if (!node.IsScalar()) {
      return nullptr;
    }
    const std::string& text = node.Scalar();
    const bool quoted = node.Tag() == "!";
    if (quoted) {
      return text;
    }
    if (text == "true" || text == "false") {
      return text == "true";
    }
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    const bool whole = !text.empty() && *end == '\0' && std::isfinite(number);
    if (!whole) {
      return text;
    }
    constexpr double kExact = 9007199254740992;  // 2^53
    if (number == std::floor(number) && std::fabs(number) < kExact) {
      return static_cast<std::int64_t>(number);
    }
    return number;
  }

  const std::string& file_;
  std::size_t values_ = 0;
};

bool begins_at(const YAML::Node& json, const Location& at) {
  return std::ranges::any_of(
      std::array{place("", json), text_place("", json)},
      [&](const Location& begin) { return begin.line == at.line && begin.column == at.column; });
}

/// The JSON has the entries in the order of the file.
std::optional<Location> find_place(const YAML::Node& json, const WrittenValue& written,
                                   const Location& at) {
  if (begins_at(json, at)) {
    return written.where;
  }
  if (!written.entries) {
    return std::nullopt;
  }
  auto next = json.begin();
  for (const WrittenEntry& entry : written.entries()) {
    const auto in_json = *next++;
    if (json.IsMap() && begins_at(in_json.first, at)) {
      return entry.value.where;
    }
    if (const auto found = find_place(json.IsMap() ? in_json.second : in_json, entry.value, at)) {
      return found;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string to_json(const std::string& file, const YAML::Node& node) {
  // YAML can write characters that no text may have: "\\uD800".
  return Converter(file).convert(node, 0).dump(-1, ' ', false, Json::error_handler_t::replace);
}

WrittenValue written_value(const std::string& file, const YAML::Node& node) {
  const Location where = place(file, node);
  if (!node.IsSequence() && !node.IsMap()) {
    return {node.IsScalar() ? node.Scalar() : "", where};
  }
  return {to_json(file, node), where, [file, node] {
            std::vector<WrittenEntry> entries;
            for (const auto& entry : node) {
              entries.push_back(node.IsMap() ? WrittenEntry{scalar(file, "key", entry.first),
                                                            written_value(file, entry.second)}
                                             : WrittenEntry{"", written_value(file, entry)});
            }
            return entries;
          }};
}

}  // namespace spikeloop::yaml_text

namespace spikeloop {

Location place_in_file(const WrittenValue& written, const Location& in_json) {
  const Location found =
      yaml_text::find_place(yaml_text::load(written.text, "", "value"), written, in_json)
          .value_or(written.where);
  return found.line == 0 ? written.where : found;
}

}  // namespace spikeloop
