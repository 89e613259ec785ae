#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "experiment_connections.hpp"
#include "experiment_settings.hpp"
#include "text_file.hpp"
#include "yaml_json.hpp"
#include "yaml_section.hpp"

namespace spikeloop {
namespace {

using yaml_text::place;
using yaml_text::Section;

constexpr std::uint64_t kMostBytes = 16'000'000;
/// Of nodes, and of connections: far more than any experiment has.
constexpr std::size_t kMostParts = 10'000;

std::string one_value(const Section& section, const std::string& key) {
  const YAML::Node& node = section.at(key, "");
  if (!node.IsScalar() || node.Scalar().empty()) {
    throw ConfigurationError(
        section.where(key),
        with_code(Code::wrong_shape,
                  "{}: key '{}' has {}; write one value behind it, or leave the key out",
                  section.what(), key,
                  node.IsMap()        ? "a map"
                  : node.IsSequence() ? "a list"
                                      : "no value"));
  }
  return node.Scalar();
}

WrittenValue value_of(const Section& section, const std::string& key) {
  const YAML::Node& node = section.at(key, "");
  if (node.IsSequence() || node.IsMap()) {
    return yaml_text::written_value(section.file(), node);
  }
  return {one_value(section, key), section.where(key)};
}

WrittenValue read_key(const Section& root, const ParameterDescription& key) {
  return key.type == ParameterType::map
             ? value_of(root, key.name)
             : WrittenValue{one_value(root, key.name), root.where(key.name)};
}

bool is_name(const std::string& text) {
  return std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

class Reader {
 public:
  Reader(const std::string& path, const ErrorHandler& report) : report_(report) {
    file_.path = path;
  }

  ExperimentFile read(const YAML::Node& document) {
    const Section root(file_.path, "experiment", document, experiment_keys(), report_);
    for (const ParameterDescription& key : experiment_parameters()) {
      if (root.has(key.name)) {
        attempt([&] { file_.keys[key.name] = read_key(root, key); });
      }
    }
    attempt([&] { read_plugins(root); });
    attempt([&] { read_robot(root); });
    file_.joined = attempt([&] { read_nodes(root); }) && file_.joined;
    file_.joined = attempt([&] { read_connections(root); }) && file_.joined;
    return std::move(file_);
  }

 private:
  /// Whether `work` had nothing to report.
  template <typename Work>
  bool attempt(Work&& work) {
    try {
      work();
      return true;
    } catch (const ConfigurationError& error) {
      report_(error);
      return false;
    }
  }

  static void refuse_more(std::size_t count, const char* what, const Location& where) {
    if (count > kMostParts) {
      throw ConfigurationError(
          where, with_code(Code::out_of_bounds,
                           "key '{}': there are {} {}; an experiment has at most {}: write one "
                           "node of more channels in place of many",
                           what, count, what, kMostParts));
    }
  }

  ExperimentNode read_keys(const std::string& what, const std::string& name, const Location& where,
                           const YAML::Node& node) {
    const Section section(file_.path, what, node, {}, report_);
    ExperimentNode result{name, {}, where};
    for (const std::string& key : section.keys()) {
      result.places[key] = section.where_name(key);
      if (!attempt([&] { result.keys[key] = value_of(section, key); })) {
        result.unread.push_back(key);
      }
    }
    return result;
  }

  void read_node(const std::string& name, const Location& where, const YAML::Node& node) {
    if (!is_name(name)) {
      throw ConfigurationError(
          where, with_code(Code::invalid_name,
                           "'{}' is not a valid node name; write letters, digits and '_'", name));
    }
    if (!node.IsMap()) {
      throw ConfigurationError(
          where, with_code(Code::missing_key,
                           "node '{0}' has no keys; write  {0}: {{node: rate_encoder}}", name));
    }
    file_.nodes.push_back(read_keys(fmt::format("node '{}'", name), name, where, node));
  }

  void read_nodes(const Section& root) {
    constexpr const char* kExample = "{encoder: {node: rate_encoder}}";
    const YAML::Node& map = root.at("nodes", kExample);
    file_.where_nodes = root.where_name("nodes");
    const bool empty = map.IsNull() || ((map.IsMap() || map.IsSequence()) && map.size() == 0);
    if (empty || !map.IsMap()) {
      throw ConfigurationError(
          file_.where_nodes,
          with_code(Code::wrong_shape, "key 'nodes': {}; write  nodes: {}",
                    empty ? "there are no nodes" : "expected a map of nodes", kExample));
    }
    refuse_more(map.size(), "nodes", file_.where_nodes);
    const Section nodes(file_.path, "key 'nodes'", map, {}, report_);
    for (const std::string& name : nodes.keys()) {
      file_.joined =
          attempt([&] { read_node(name, nodes.where_name(name), nodes.at(name, "")); }) &&
          file_.joined;
    }
  }

  /// a.out, or a list of such.
  std::vector<ExperimentConnection> read_from(const YAML::Node& node) {
    const auto read = [&](const YAML::Node& text) {
      return experiment_text::read_senders(yaml_text::scalar(file_.path, "from", text),
                                           yaml_text::text_place(file_.path, text));
    };
    if (!node.IsSequence()) {
      return read(node);
    }
    std::vector<ExperimentConnection> senders;
    for (const YAML::Node& item : node) {
      const std::vector<ExperimentConnection> sender = read(item);
      if (sender.size() > 1) {
        throw ConfigurationError(
            place(file_.path, item),
            with_code(Code::wrong_shape,
                      "key 'from': '{}' has several senders in one entry of a list; write one in "
                      "each entry, or  from: left + right  for their sum",
                      item.Scalar()));
      }
      senders.push_back(sender.front());
      senders.back().combination = senders.size() == 1 ? Combination::alone : Combination::appended;
    }
    if (senders.empty()) {
      throw ConfigurationError(
          place(file_.path, node),
          with_code(Code::wrong_shape, "key 'from' has an empty list; write  from: [left, right]"));
    }
    return senders;
  }

  /// {from: a.out, to: b.in, width: 2, delay: 5 ms}
  std::vector<ExperimentConnection> read_arrow(const YAML::Node& node) {
    const Section arrow(file_.path, "connection", node, names_of(connection_parameters()));
    std::vector<ExperimentConnection> connections = read_from(arrow.at("from", "scan"));
    for (ExperimentConnection& connection : connections) {
      connection.to = arrow.text("to", "encoder");
      connection.where = arrow.where("to");
      experiment_text::check_end(connection.to, connection.where);
      if (arrow.has("width")) {
        connection.width =
            experiment_text::read_width(arrow.text("width", "100"), arrow.where("width"));
      }
      if (arrow.has("delay")) {
        connection.delay = {arrow.text("delay", "5 ms"), arrow.where("delay")};
      }
    }
    return connections;
  }

  void read_connection(const YAML::Node& item) {
    if (item.IsMap()) {
      const std::vector<ExperimentConnection> arrow = read_arrow(item);
      file_.connections.insert(file_.connections.end(), arrow.begin(), arrow.end());
    } else if (!item.IsScalar()) {
      throw ConfigurationError(
          place(file_.path, item),
          with_code(Code::wrong_shape,
                    "a connection is a line or a map, this is {}; write  - scan -> encoder [100]",
                    item.IsSequence() ? "a list" : "nothing"));
    } else {
      experiment_text::read_connections(yaml_text::scalar(file_.path, "connections", item),
                                        yaml_text::text_place(file_.path, item), file_.connections);
    }
  }

  void read_connections(const Section& root) {
    const YAML::Node& list = root.at("connections", "[\"scan -> encoder [100] -> brain [100]\"]");
    file_.where_connections = root.where_name("connections");
    if (!list.IsSequence() || list.size() == 0) {
      throw ConfigurationError(
          file_.where_connections,
          with_code(
              Code::wrong_shape,
              "key 'connections': {}; write lines of  - scan -> encoder [100] -> brain",
              list.IsNull() || list.IsSequence() ? "there are no connections" : "expected a list"));
    }
    for (const YAML::Node& item : list) {
      refuse_more(std::max(list.size(), file_.connections.size()), "connections",
                  file_.where_connections);
      file_.joined = attempt([&] { read_connection(item); }) && file_.joined;
    }
    refuse_more(file_.connections.size(), "connections", file_.where_connections);
  }

  void read_plugins(const Section& root) {
    if (!root.has("plugins")) {
      return;
    }
    const YAML::Node& list = root.at("plugins", "");
    if (!list.IsSequence()) {
      throw ConfigurationError(
          root.where("plugins"),
          with_code(Code::wrong_shape,
                    "key 'plugins': expected a list of files; write  plugins: [my_encoder.so]"));
    }
    for (const YAML::Node& item : list) {
      if (!item.IsScalar() || item.Scalar().empty()) {
        throw ConfigurationError(place(file_.path, item),
                                 with_code(Code::wrong_shape,
                                           "key 'plugins': an entry is not a path of a file; write "
                                           " plugins: [my_encoder.so]"));
      }
      file_.plugins.push_back({item.Scalar(), place(file_.path, item)});
    }
  }

  void read_robot(const Section& root) {
    if (!root.has("robot")) {
      return;
    }
    const YAML::Node& robot = root.at("robot", "");
    if (!robot.IsMap()) {
      // There is one all the same: topics are not said to lead nowhere.
      file_.robot = {"robot", {}, root.where("robot"), {"simulator"}, {}};
      throw ConfigurationError(root.where("robot"),
                               with_code(Code::wrong_shape,
                                         "key 'robot': expected a map; write  robot: {simulator: "
                                         "mujoco, world: arena.xml}, or  robot: {bag: FILE}, or "
                                         "leave it out if the robot is reached over ROS"));
    }
    file_.robot = read_keys("robot", "robot", root.where_name("robot"), robot);
  }

  const ErrorHandler& report_;
  ExperimentFile file_;
};

/// The length of the UTF-8 character that begins here; 0: there is none.
std::size_t character(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  const auto rest = text.substr(std::min<std::size_t>(text.size(), 1), length - (length > 0));
  const bool whole = std::ranges::all_of(
      rest, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; });
  return length <= text.size() && whole ? length : 0;
}

void check_text(std::string_view text, const std::string& path) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = text[at] == '\0' ? 0 : character(text.substr(at));
    if (length == 0) {
      throw ConfigurationError(locate(text, at, path),
                               with_code(Code::syntax,
                                         "the byte 0x{:02X} is not UTF-8 text; save the file as "
                                         "UTF-8 ('spikeloop new' prints an "
                                         "experiment to begin with)",
                                         static_cast<unsigned char>(text[at])));
    }
    at += length;
  }
}

YAML::Node load(std::string_view text, const std::string& path) {
  check_text(text, path);
  const YAML::Node document = yaml_text::load(std::string(text), path, "experiment");
  if (!document.IsMap()) {
    throw ConfigurationError(
        document.IsDefined() && !document.IsNull() ? place(path, document) : Location{path, 0, 0},
        with_code(Code::wrong_shape, "{}; 'spikeloop new' prints one to begin with",
                  document.IsDefined() && !document.IsNull()
                      ? "this is not an experiment: expected lines of  key: value"
                      : "there is no experiment in this file"));
  }
  if (document["populations"] && !document["nodes"]) {
    throw ConfigurationError(
        Location{path, 0, 0},
        with_code(
            Code::wrong_shape,
            "this is a network, not an experiment; write in an experiment  brain: {{simulator: "
            "builtin, network: {}}}",
            std::filesystem::path(path).filename().string()));
  }
  return document;
}

[[noreturn]] void raise(const ConfigurationError& error) {
  throw error;
}

}  // namespace

std::vector<std::string> experiment_keys() {
  std::vector<std::string> keys = names_of(experiment_parameters());
  keys.insert(keys.end(), {"robot", "plugins", "nodes", "connections"});
  return keys;
}

ExperimentFile parse_experiment(std::string_view text, const std::string& path,
                                const ErrorHandler& report, const Settings& settings) {
  const YAML::Node document = load(text, path);
  for (const Setting& setting : settings) {
    experiment_text::apply(setting, document);
  }
  ExperimentFile file = Reader(path, report).read(document);
  for (const Setting& setting : settings) {
    experiment_text::mark_place(setting, file);
  }
  return file;
}

ExperimentFile parse_experiment(std::string_view text, const std::string& path) {
  return parse_experiment(text, path, raise);
}

ExperimentFile read_experiment_file(const std::filesystem::path& path, const ErrorHandler& report,
                                    const Settings& settings) {
  return parse_experiment(read_file(path.string(), "YAML file", kMostBytes), path.string(), report,
                          settings);
}

ExperimentFile read_experiment_file(const std::filesystem::path& path) {
  return read_experiment_file(path, raise);
}

}  // namespace spikeloop
