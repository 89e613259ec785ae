#include "experiment_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "node_text.hpp"
#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/config/parameter_text.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::app {
namespace {

std::string section(const std::string& title, const std::string& line, const std::string& table,
                    bool markdown) {
  return markdown ? fmt::format("\n### {}\n\n{}\n\n```text\n{}```\n", title, line, table)
                  : fmt::format("{}: {}\n\n{}\n", title, line, table);
}

std::string how_to_simulate() {
  std::vector<std::string> names;
  for (const experiment::Simulator& simulator : experiment::simulators()) {
    names.emplace_back(simulator.name);
  }
  return fmt::format(
      "Write  simulator: NAME  in an experiment file, one of {}; ports and kinds are "
      "those of the connections (docs/simulators.md).",
      fmt::join(names, ", "));
}

std::string how_to_write(const NodeDescription& description) {
  if (description.name == experiment::simulator_description().name) {
    return how_to_simulate();
  }
  return description.name == experiment::kNetwork
             ? "Write  simulator: builtin  in an experiment file. The key network is a file, or a "
               "map with the same content. Its populations define the widths of the ports."
             : fmt::format("Write  node: {}  in an experiment file.", description.name);
}

}  // namespace

std::vector<std::string> experiment_classes(const experiment::NodeTypes& types) {
  auto names = types.endpoints();
  names.emplace_back(experiment::kNetwork);
  std::ranges::sort(names);
  return names;
}

std::string experiment_class_list(const experiment::NodeTypes& types) {
  std::string text = "Only in experiment files: topics, recordings, the network, simulators\n";
  for (const std::string& name : experiment_classes(types)) {
    text += fmt::format("  {:<27}  {}\n", name, types.find(name).description.text);
  }
  const NodeDescription& simulator = experiment::simulator_description();
  text += fmt::format("  {:<27}  {}\n", simulator.name, simulator.text);
  return text;
}

std::string experiment_class_text(const NodeDescription& description) {
  std::string text = fmt::format("{}: {}\n", description.name, description.text);
  text += description.source.empty() ? "" : fmt::format("Source: {}\n", description.source);
  return fmt::format("{}\n{}\n{}\n", text, tables(description), how_to_write(description));
}

std::string experiment_reference(const experiment::NodeTypes& types, bool markdown) {
  std::string text =
      section("The file", "Top-level keys besides robot, plugins, nodes and connections.",
              parameter_text(experiment_parameters()), markdown);
  text += section("robot",
                  "Robot that is simulated in this process, or what replaces it: write  "
                  "simulator, environment  or  bag.",
                  parameter_text(robot_parameters()), markdown);
  text +=
      section("nodes", "Keys of every node, beside  node  or  simulator  and those of its class.",
              parameter_text(node_parameters()), markdown);
  text += section("connections", "Keys of a connection that is written as a map.",
                  parameter_text(connection_parameters()), markdown);
  for (const std::string& name : experiment_classes(types)) {
    const NodeDescription& description = types.find(name).description;
    text += section(name, fmt::format("{}. {}", description.text, how_to_write(description)),
                    tables(description), markdown);
  }
  const NodeDescription& simulator = experiment::simulator_description();
  text += section(simulator.name, fmt::format("{}. {}", simulator.text, how_to_write(simulator)),
                  tables(simulator), markdown);
  return text;
}

}  // namespace spikeloop::app
