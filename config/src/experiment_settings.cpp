#include "experiment_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "yaml_json.hpp"
#include "yaml_section.hpp"

namespace spikeloop {
namespace {

/// "encoder" and "rate_max" of "encoder.rate_max".
std::pair<std::string, std::string> split_key(std::string_view key) {
  const auto dot = key.find('.');
  return {std::string(key.substr(0, dot)),
          dot == std::string_view::npos ? "" : std::string(key.substr(dot + 1))};
}

/// A value that has no place in the file.
YAML::Node without_place(const YAML::Node& node) {
  YAML::Node copy(node.Type());
  if (node.IsScalar()) {
    copy = node.Scalar();
    copy.SetTag(node.Tag());
  }
  for (const auto& entry : node) {
    if (node.IsMap()) {
      copy.force_insert(without_place(entry.first), without_place(entry.second));
    } else {
      copy.push_back(without_place(entry));
    }
  }
  return copy;
}

class Setter {
 public:
  explicit Setter(const Setting& setting) : setting_(setting) {
    const YAML::Node value = yaml_text::load(setting.value, setting.option, "value");
    yaml_text::to_json(setting.option, value);  // its depth and size have bounds
    value_.reset(without_place(value));
  }

  void set(YAML::Node document) {
    const auto [first, rest] = split_key(setting_.key);
    if (first == "nodes" && !rest.empty()) {
      set_node(document, rest);
    } else if (first == "robot" || is_key(first)) {
      descend(document, setting_.key, 0);
    } else {
      set_node(document, setting_.key);
    }
  }

 private:
  static bool is_key(const std::string& name) {
    return std::ranges::count(experiment_keys(), name) > 0;
  }

  [[noreturn]] void refuse(Code code, const std::string& why) const {
    throw ConfigurationError(Location{setting_.option}, with_code(code, why));
  }

  void set_node(YAML::Node document, const std::string& path) {
    const YAML::Node nodes = document["nodes"];
    const std::string name = split_key(path).first;
    if (!nodes.IsMap()) {
      return;  // which is an error of the file
    }
    const bool is_new_node = path == name && value_.IsMap();
    if (!nodes[name].IsDefined() && !is_new_node) {
      std::vector<std::string> known = experiment_keys();
      for (const auto& entry : nodes) {
        known.push_back(entry.first.IsScalar() ? entry.first.Scalar() : "");
      }
      refuse(Code::unknown_node,
             fmt::format("there is no node or key '{}'{}", name, did_you_mean(name, known)));
    }
    descend(nodes, path, 0);
  }

  /// The longest key of the map that the path begins with: keys may have dots ("linear.x").
  static std::string known_key(const YAML::Node& map, const std::string& path) {
    std::string longest;
    for (const auto& entry : map) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (key.size() > longest.size() && (path + ".").starts_with(key + ".")) {
        longest = key;
      }
    }
    return longest;
  }

  void descend(YAML::Node node, const std::string& path, int depth) {
    if (node.IsSequence()) {
      descend_list(node, path, depth);
      return;
    }
    if (!node.IsMap() && !node.IsNull()) {
      refuse(Code::wrong_shape, fmt::format("there is no '{}' in the value '{}'; write the whole "
                                            "value, as a map or a list",
                                            path, node.Scalar()));
    }
    std::string key = known_key(node, path);
    if (key.empty()) {  // a new key; those within the value of another one may have dots
      key = depth < 2 ? split_key(path).first : path;
    }
    if (key == path) {
      node[key] = value_;
      return;
    }
    if (!std::as_const(node)[key].IsDefined()) {
      node[key] = YAML::Node(YAML::NodeType::Map);
    }
    descend(node[key], path.substr(key.size() + 1), depth + 1);
  }

  void descend_list(YAML::Node list, const std::string& path, int depth) {
    const auto [first, rest] = split_key(path);
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(first.data(), first.data() + first.size(), index);
    if (error != std::errc() || end != first.data() + first.size() || index >= list.size()) {
      refuse(Code::out_of_bounds,
             list.size() == 0
                 ? fmt::format("there is no '{}' in an empty list; write the whole value", first)
                 : fmt::format("'{}' is not an entry of a list of {}; write a number from 0 to {}",
                               first, list.size(), list.size() - 1));
    }
    if (rest.empty()) {
      list[index] = value_;
    } else {
      descend(list[index], rest, depth + 1);
    }
  }

  const Setting& setting_;
  YAML::Node value_;
};

void mark(WrittenValues& values, std::map<std::string, Location>* places, const std::string& key,
          const Location& where) {
  if (const auto found = values.find(key); found != values.end()) {
    found->second.where = where;
    if (places != nullptr) {
      (*places)[key] = where;
    }
  }
}

}  // namespace

Setting parse_setting(const std::string& text) {
  const auto equals = text.find('=');
  Setting setting{text.substr(0, equals), "", "--set " + text.substr(0, equals)};
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    throw ConfigurationError(with_code(Code::syntax,
                                       "--set {}: expected KEY=VALUE; write for example  --set "
                                       "encoder.rate_max=\"100 Hz\"",
                                       text));
  }
  setting.value = text.substr(equals + 1);
  return setting;
}

std::string to_text(const Settings& settings) {
  nlohmann::json list = nlohmann::json::array();
  for (const Setting& setting : settings) {
    list.push_back({setting.key, setting.value, setting.option});
  }
  return list.dump();
}

Settings settings_from_text(const std::string& text) {
  Settings settings;
  for (const auto& entry : nlohmann::json::parse(text)) {
    settings.push_back({entry.at(0), entry.at(1), entry.at(2)});
  }
  return settings;
}

namespace experiment_text {

void apply(const Setting& setting, YAML::Node document) {
  Setter(setting).set(std::move(document));
}

void mark_place(const Setting& setting, ExperimentFile& file) {
  const Location where{setting.option};
  auto [first, rest] = split_key(setting.key);
  if (rest.empty()) {
    mark(file.keys, nullptr, first, where);
    return;
  }
  if (first == "nodes") {
    std::tie(first, rest) = split_key(rest);
  }
  if (first == "robot" && file.robot) {
    mark(file.robot->keys, &file.robot->places, rest, where);
  }
  for (ExperimentNode& node : file.nodes) {
    if (node.name == first) {
      mark(node.keys, &node.places, rest, where);
    }
  }
}

}  // namespace experiment_text
}  // namespace spikeloop
