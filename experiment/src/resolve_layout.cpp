// The key `layout`: which nodes share a process.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "faults.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::experiment {
namespace {

constexpr const char* kKey = "layout";
constexpr std::string_view kRobotLabel = "robot";  // what the launcher calls spikeloop-robot

void check_process(const std::string& name, const Location& where, const Experiment& experiment) {
  const bool plain =
      std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  if (!plain || name.empty()) {
    throw ConfigurationError(
        where, with_code(Code::invalid_name,
                         "key 'layout': '{}' is not the name of a process; write letters, digits "
                         "and '_'",
                         name));
  }
  if (name == kRobotLabel) {
    throw ConfigurationError(
        where,
        with_code(Code::layout,
                  "key 'layout': 'robot' is the process of the robot; give this one another name"));
  }
  if (is_simulator_end(experiment, name)) {
    throw ConfigurationError(
        where, with_code(Code::layout,
                         "key 'layout': '{}' is a simulator, which has a process of its own; "
                         "give this process another name",
                         name));
  }
}

void check_node(const std::string& name, const Location& where, const Experiment& experiment) {
  std::vector<std::string> names;
  for (const Node& node : experiment.nodes) {
    names.push_back(node.name);
  }
  if (std::ranges::find(names, name) == names.end()) {
    throw ConfigurationError(
        where, with_code(Code::unknown_node, "key 'layout': there is no node '{}'{}", name,
                         did_you_mean(name, names)));
  }
  if (is_simulator_end(experiment, name)) {
    throw ConfigurationError(
        where,
        with_code(Code::layout,
                  "key 'layout': the simulator '{}' has a process of its own; leave it out", name));
  }
  if (const auto in = std::ranges::find_if(
          experiment.layout.processes,
          [&](const Process& process) { return process.nodes.contains(name); });
      in != experiment.layout.processes.end()) {
    throw ConfigurationError(
        where,
        with_code(Code::layout, "key 'layout': node '{}' is in process '{}' already; write it once",
                  name, in->name));
  }
}

/// Every node is somewhere.
void check_whole(const Experiment& experiment) {
  for (const Node& node : experiment.nodes) {
    const bool listed = std::ranges::any_of(
        experiment.layout.processes,
        [&](const Process& process) { return process.nodes.contains(node.name); });
    if (!listed && !is_simulator(node)) {
      throw ConfigurationError(
          experiment.layout.where,
          with_code(Code::layout, "key 'layout': node '{}' is in no process; add it to one of them",
                    node.name));
    }
  }
}

/// One process talks with the robot, but over ROS in wall time any may.
void check_robot(const Experiment& experiment) {
  const bool in_steps = experiment.sync == Sync::lockstep || experiment.sync == Sync::sim_time;
  const bool over_ros = experiment.ros != Ros::none;
  if ((over_ros && !in_steps) || one_meets_robot(experiment)) {
    return;
  }
  const bool bag = experiment.robot && !experiment.robot->bag.empty();
  const std::string what = bag        ? "a bag"
                           : in_steps ? fmt::format("sync: {}", name_of(experiment.sync))
                                      : std::string("a robot without ROS");
  const char* const remedy = bag                     ? ""
                             : in_steps && !over_ros ? ", or write  sync: realtime  and  ros: 2"
                             : in_steps              ? ", or write  sync: realtime"
                                                     : ", or write  ros: 2";
  throw ConfigurationError(
      experiment.layout.where,
      with_code(
          Code::layout,
          "key 'layout': {} needs all sensors and commands in one process; put them together{}",
          what, remedy));
}

/// No simulator is named so.
std::string fused_label(const Experiment& experiment) {
  std::string label = "experiment";
  while (is_simulator_end(experiment, label)) {
    label += '_';
  }
  return label;
}

/// One process has all nodes.
void take_fused(Experiment& experiment) {
  Process process{fused_label(experiment)};
  for (const Node& node : experiment.nodes) {
    if (!is_simulator(node)) {
      process.nodes.insert(node.name);
    }
  }
  experiment.layout.processes.push_back(std::move(process));
}

/// A process for each node. One without connections shares the first one: MUSIC would wait for ever
/// for a process of its own.
void take_separate(bool whole, Experiment& experiment, Faults& faults) {
  std::vector<Process>& processes = experiment.layout.processes;
  const bool known = !experiment.connections.empty();  // none where one of them is wrong
  std::set<std::string> alone;
  for (const Node& node : experiment.nodes) {
    if (is_simulator(node)) {
      continue;
    }
    if (known && std::ranges::none_of(experiment.connections, [&](const Connection& connection) {
          return node_of(connection.from) == node.name || node_of(connection.to) == node.name;
        })) {
      alone.insert(node.name);
      continue;
    }
    faults.attempt(node.where, [&] { check_process(node.name, node.where, experiment); });
    processes.push_back({node.name, {node.name}});
  }
  if (!processes.empty()) {
    processes.front().nodes.merge(alone);
  }
  if (whole) {
    faults.attempt(experiment.layout.where, [&] { check_robot(experiment); });
  }
}

/// The processes, simulators among them, that take from one.
std::map<std::string, std::set<std::string>> receivers_of(const Experiment& experiment) {
  std::map<std::string, std::set<std::string>> receivers;
  for (const Connection& connection : experiment.connections) {
    const std::string from = process_of(experiment, node_of(connection.from));
    const std::string to = process_of(experiment, node_of(connection.to));
    if (from != to) {
      receivers[from].insert(to);
    }
  }
  return receivers;
}

void find_cycles(Experiment& experiment) {
  auto receivers = receivers_of(experiment);
  for (Process& process : experiment.layout.processes) {
    std::set<std::string> reached;
    std::vector<std::string> open{process.name};
    while (!open.empty()) {
      const std::string current = open.back();
      open.pop_back();
      for (const std::string& next : receivers[current]) {
        if (reached.insert(next).second) {
          open.push_back(next);
        }
      }
    }
    process.in_cycle = reached.contains(process.name);
  }
}

void take_processes(const Parameters& keys, bool whole, Experiment& experiment, Faults& faults) {
  Layout& layout = experiment.layout;
  const std::size_t before = faults.count();
  if (keys.entries(kKey).empty()) {
    faults.add(layout.where, with_code(Code::layout,
                                       "key 'layout': there are no processes; "
                                       "write  layout: {vision: [camera], control: "
                                       "[encoder, decoder, wheels]}, or leave it out"));
  }
  for (const Parameters::Entry& process : keys.entries(kKey)) {
    faults.attempt(process.where, [&] { check_process(process.key, process.where, experiment); });
    layout.processes.push_back({process.key});
    for (const Parameters::Entry& node : process.values.entries(kAnyKey)) {
      const std::string& name = node.values.text("node");
      if (faults.attempt(node.where, [&] { check_node(name, node.where, experiment); })) {
        layout.processes.back().nodes.insert(name);
      }
    }
  }
  if (whole && faults.count() == before) {
    faults.attempt(layout.where, [&] {
      check_whole(experiment);
      check_robot(experiment);
    });
  }
}

}  // namespace

void resolve_layout(const Parameters& keys, bool whole, Experiment& experiment, Faults& faults) {
  const std::string kind = keys.word(kKey);
  Layout& layout = experiment.layout;
  layout.where = keys.where(kKey);
  layout.kind = kind.empty()         ? Layout::Kind::written
                : kind == "separate" ? Layout::Kind::separate
                                     : Layout::Kind::fused;
  if (layout.kind == Layout::Kind::written) {
    take_processes(keys, whole, experiment, faults);
  } else if (layout.kind == Layout::Kind::separate) {
    take_separate(whole, experiment, faults);
  }
  if (layout.processes.empty()) {
    take_fused(experiment);
  }
  find_cycles(experiment);
}

}  // namespace spikeloop::experiment
