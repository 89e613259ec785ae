#include "spikeloop/config/experiment_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "experiment_connections.hpp"
#include "text_file.hpp"
#include "yaml_json.hpp"
#include "yaml_section.hpp"

namespace spikeloop {
namespace {

using yaml_text::place;
using yaml_text::Section;

constexpr std::uint64_t kMostBytes = 16'000'000;
constexpr const char* kHolders[] = {"robot", "plugins", "nodes", "connections"};

/// The value of a key; a list or map becomes JSON.
WrittenValue value_of(const Section& section, const std::string& key) {
  const YAML::Node& node = section.at(key, "");
  if (node.IsSequence() || node.IsMap()) {
    return {yaml_text::to_json(section.file(), node), section.where(key)};
  }
  return {section.text(key, "..."), section.where(key)};
}

bool is_name(const std::string& text) {
  return std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

ExperimentNode read_node(const std::string& file, const std::string& name, const Location& where,
                         const YAML::Node& node) {
  if (!is_name(name)) {
    throw ConfigurationError(
        where, fmt::format("'{}' is no name of a node; write letters, digits and '_'", name));
  }
  if (!node.IsMap()) {
    throw ConfigurationError(
        where, fmt::format("node '{0}' has no keys; write  {0}: {{node: rate_encoder}}", name));
  }
  const Section section(file, fmt::format("node '{}'", name), node, {});
  ExperimentNode result{name, {}, where};
  for (const std::string& key : section.keys()) {
    result.keys[key] = value_of(section, key);
  }
  return result;
}

void read_nodes(const Section& root, ExperimentFile& result) {
  constexpr const char* kExample = "{encoder: {node: rate_encoder}}";
  result.where_nodes = root.where("nodes");
  const Section nodes(result.path, "key 'nodes'", root.at("nodes", kExample), {});
  for (const std::string& name : nodes.keys()) {
    result.nodes.push_back(
        read_node(result.path, name, nodes.where_name(name), nodes.at(name, "")));
  }
  if (result.nodes.empty()) {
    throw ConfigurationError(result.where_nodes,
                             fmt::format("there are no nodes; write  nodes: {}", kExample));
  }
}

/// {from: a.out, to: b.in, width: 2, delay: 5 ms}
ExperimentConnection read_arrow(const std::string& file, const YAML::Node& node) {
  const Section arrow(file, "connection", node, {"from", "to", "width", "delay"});
  ExperimentConnection connection{
      arrow.text("from", "scan"), arrow.text("to", "encoder"), 0, {}, arrow.where("to")};
  if (arrow.has("width")) {
    std::vector<ExperimentConnection> parsed;
    experiment_text::read_connections(fmt::format("a -> b [{}]", arrow.text("width", "100")),
                                      {file, 0, 0}, parsed);
    connection.width = parsed.front().width;
  }
  if (arrow.has("delay")) {
    connection.delay = {arrow.text("delay", "5 ms"), arrow.where("delay")};
  }
  return connection;
}

void read_connections(const Section& root, ExperimentFile& result) {
  constexpr const char* kExample = "[\"scan -> encoder [100] -> brain [100]\"]";
  result.where_connections = root.where("connections");
  const YAML::Node& list = root.at("connections", kExample);
  if (!list.IsSequence() || list.size() == 0) {
    throw ConfigurationError(
        result.where_connections,
        "key 'connections': expected a list; write lines of  - scan -> encoder [100] -> brain");
  }
  for (const YAML::Node& item : list) {
    if (item.IsMap()) {
      result.connections.push_back(read_arrow(result.path, item));
    } else {
      experiment_text::read_connections(yaml_text::scalar(result.path, "connections", item),
                                        place(result.path, item), result.connections);
    }
  }
}

void read_plugins(const Section& root, ExperimentFile& result) {
  if (!root.has("plugins")) {
    return;
  }
  const YAML::Node& list = root.at("plugins", "[encoder.py]");
  if (!list.IsSequence()) {
    throw ConfigurationError(root.where("plugins"),
                             "key 'plugins': expected a list of files; write  [encoder.py]");
  }
  for (const YAML::Node& item : list) {
    result.plugins.push_back(
        {yaml_text::scalar(result.path, "plugins", item), place(result.path, item)});
  }
}

void read_robot(const Section& root, ExperimentFile& result) {
  if (!root.has("robot")) {
    return;
  }
  const YAML::Node& robot = root.at("robot", "");
  if (!robot.IsMap()) {
    throw ConfigurationError(
        root.where("robot"),
        "key 'robot': expected a map; write  robot: {simulator: mujoco, world: arena.xml}, or "
        "leave it out when the robot is somewhere else");
  }
  result.robot = read_node(result.path, "robot", root.where_name("robot"), robot);
}

}  // namespace

std::vector<ParameterDescription> experiment_parameters() {
  return {
      {.name = "experiment",
       .type = ParameterType::text,
       .default_value = "",
       .text = "Its name; that of the file when it is left out"},
      {.name = "duration",
       .unit = "s",
       .default_value = "",
       .minimum = 0,
       .maximum = 9e9,
       .text = "Simulated time; without it, the experiment runs until it is stopped"},
      {.name = "tick",
       .unit = "s",
       .default_value = "1 ms",
       .minimum = 1e-9,
       .maximum = 1000,
       .text = "How often sensors, network and commands exchange their data"},
      {.name = "seed",
       .type = ParameterType::integer,
       .default_value = "1",
       .minimum = 0,
       .text = "Seed of all random numbers, with the node's name"},
      {.name = "sync",
       .type = ParameterType::choice,
       .default_value = "realtime",
       .choices = {"realtime", "unpaced", "lockstep", "sim_time"},
       .text =
           "What simulated time waits for: the wall clock, nothing, the robot simulator tick by "
           "tick, the topic /clock"},
      {.name = "real_time_factor",
       .unit = "1",
       .default_value = "1",
       .minimum = 0.001,
       .maximum = 1000,
       .text = "Simulated time over wall time, with sync: realtime"},
      {.name = "ros",
       .type = ParameterType::choice,
       .default_value = "none",
       .choices = {"none", "1", "2"},
       .text = "What carries messages; none: memory, between this process and its own robot"},
  };
}

ExperimentFile parse_experiment(std::string_view text, const std::string& path) {
  std::vector<std::string> known = names_of(experiment_parameters());
  const std::vector<std::string> plain = known;
  known.insert(known.end(), std::begin(kHolders), std::end(kHolders));
  const YAML::Node document = yaml_text::load(std::string(text), path, "experiment");
  if (!document.IsMap()) {
    throw ConfigurationError(
        place(path, document),
        "this is no experiment: expected lines of  key: value; 'spikeloop new' "
        "prints one to begin with");
  }
  const Section root(path, "experiment", document, known);
  ExperimentFile result;
  result.path = path;
  for (const std::string& key : plain) {
    if (root.has(key)) {
      result.keys[key] = {root.text(key, "..."), root.where(key)};
    }
  }
  read_plugins(root, result);
  read_robot(root, result);
  read_nodes(root, result);
  read_connections(root, result);
  return result;
}

ExperimentFile read_experiment_file(const std::filesystem::path& path) {
  return parse_experiment(read_text_file(path, kMostBytes, "experiment file"), path.string());
}

}  // namespace spikeloop
