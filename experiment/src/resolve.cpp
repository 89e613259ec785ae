#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "faults.hpp"
#include "spikeloop/bag/reader.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/units.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {
namespace {

constexpr const char* kAll = "all";

Location where_of(const ExperimentFile& file, const char* key) {
  const auto found = file.keys.find(key);
  return found == file.keys.end() ? Location{file.path, 0, 0} : found->second.where;
}

void read_times(const Parameters& keys, Experiment& experiment, Faults& faults) {
  if (keys.given("duration")) {
    faults.attempt(keys.where("duration"),
                   [&] { experiment.duration = from_seconds(keys.number("duration")); });
  }
  faults.attempt(keys.where("tick"),
                 [&] { experiment.tick = tick_from_seconds(keys.number("tick")); });
}

/// As delays: a run has as many ticks as its duration says, no more and no less.
void check_duration(const Location& where, const Experiment& experiment, Faults& faults) {
  const TimeNs duration = experiment.duration.value_or(experiment.tick);
  const TimeNs rest = duration % experiment.tick;
  if (duration <= 0) {
    faults.add(where, with_code(Code::out_of_bounds,
                                "key 'duration': a run of {} does nothing; write for example "
                                "{}, or leave it out: then the run goes on until it is stopped",
                                format_time(duration), format_time(experiment.tick)));
  } else if (rest != 0) {
    const TimeNs below = duration - rest;
    faults.add(where,
               with_code(Code::off_grid,
                         "key 'duration': {} is not a whole number of ticks of {}; write {}{}",
                         format_time(duration), format_time(experiment.tick),
                         below > 0 ? format_time(below) + " or " : "",
                         format_time(below + experiment.tick)));
  }
}

/// It names the run folder and the node of ROS.
void check_name(const Parameters& keys, const std::string& name, Faults& faults) {
  constexpr std::size_t kLongest = 100;
  const bool plain = std::ranges::all_of(
      name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
  if (keys.given("experiment") && (!plain || name.size() > kLongest)) {
    faults.add(keys.where("experiment"),
               with_code(Code::invalid_name,
                         "key 'experiment': '{}' is not a valid experiment name; write up to {} "
                         "letters, digits, '_' and '-'",
                         name, kLongest));
  }
}

std::optional<double> number_of(const Parameters& keys, const char* name) {
  return keys.given(name) ? std::optional(keys.number(name)) : std::nullopt;
}

void read_episodes(const Parameters& keys, Experiment& experiment, Faults& faults) {
  if (!keys.given("episodes")) {
    return;
  }
  const Parameters& read = keys.map("episodes");
  faults.attempt(keys.where("episodes"), [&] {
    Episodes episodes;
    if (read.given("count")) {
      episodes.count = static_cast<std::uint64_t>(read.integer("count"));
    }
    if (read.given("time_limit")) {
      episodes.time_limit = from_seconds(read.number("time_limit"));
    }
    episodes.hold = from_seconds(read.number("hold"));
    episodes.pause = from_seconds(read.number("pause"));
    episodes.pause_observation = number_of(read, "pause_observation");
    episodes.begin_reward = number_of(read, "begin_reward");
    episodes.end_reward = number_of(read, "end_reward");
    episodes.failure_reward = number_of(read, "failure_reward");
    episodes.collision_reward = number_of(read, "collision_reward");
    episodes.goal = read.text("goal");
    for (const Parameters::Entry& entry : read.entries("reset")) {
      episodes.reset.push_back(entry.values.text("node"));
    }
    experiment.episodes = episodes;
  });
}

void take_keys(const ExperimentFile& file, const Parameters& keys, Experiment& experiment,
               Faults& faults) {
  read_times(keys, experiment, faults);
  const std::string& name = keys.text("experiment");
  experiment.name = name.empty() ? std::filesystem::path(file.path).stem().string() : name;
  check_name(keys, name, faults);
  experiment.seed = static_cast<std::uint64_t>(keys.integer("seed"));
  experiment.sync = sync_named(keys.text("sync"));
  experiment.real_time_factor = keys.number("real_time_factor");
  experiment.on_write_failure = on_write_failure_of(keys.text(kOnWriteFailureKey));
  experiment.ros = ros_named(keys.text("ros"));
  read_episodes(keys, experiment, faults);
}

/// A fault in one key leaves the others' checks alone: its default stands in.
Parameters read_keys(const ExperimentFile& file, Experiment& experiment, Faults& faults) {
  const std::size_t before = faults.count();
  const Parameters keys = resolve_keys(
      experiment_parameters(), {file.keys, "experiment", {file.path, 0, 0}, {}, {}}, {}, faults);
  take_keys(file, keys, experiment, faults);
  if (faults.count() == before) {
    check_duration(where_of(file, "duration"), experiment, faults);
  }
  experiment.sync_where = where_of(file, "sync");
  return keys;
}

/// Why a node cannot begin anew; empty: it can.
std::string hindrance(const Node& node) {
  switch (node.role) {
    case Role::source:
      return "it is an input of the experiment";
    case Role::sink:
      return "it is an output of the experiment";
    case Role::simulator:
      return "another program simulates it";
    case Role::node:
      break;
  }
  if (node.node_class == nullptr || node.node_class->description.reset != Reset::never) {
    return "";  // of an unknown class: that is another fault
  }
  return node.kind == kNetwork ? "it has no resolution" : "plug-ins have a state of their own";
}

std::vector<std::string> able_to_begin_anew(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const Node& node : experiment.nodes) {
    if (hindrance(node).empty()) {
      names.push_back(node.name);
    }
  }
  return names;
}

/// Puts the names of all nodes that can begin anew in the place of `all`.
void expand_reset(Experiment& experiment) {
  if (!experiment.episodes || experiment.episodes->reset != std::vector<std::string>{kAll} ||
      std::ranges::find(experiment.nodes, kAll, &Node::name) != experiment.nodes.end()) {
    return;
  }
  experiment.episodes->reset = able_to_begin_anew(experiment);
}

void check_reset(const std::string& name, const ExperimentFile& file, const Experiment& experiment,
                 Faults& faults) {
  const Location where = where_of(file, "episodes");
  const auto node = std::ranges::find(experiment.nodes, name, &Node::name);
  if (node == experiment.nodes.end()) {
    if (std::ranges::find(file.nodes, name, &ExperimentNode::name) != file.nodes.end()) {
      return;  // it has a fault of its own
    }
    if (name == kAll) {
      faults.add(where, with_code(Code::conflicting_keys,
                                  "key 'episodes': reset: 'all' stands alone; write  reset: all"));
      return;
    }
    std::vector<std::string> able = able_to_begin_anew(experiment);
    able.emplace_back(kAll);
    faults.add(where,
               with_code(Code::unknown_node, "key 'episodes': reset: there is no node '{}'{}", name,
                         did_you_mean(name, able)));
  } else if (const std::string why = hindrance(*node); !why.empty()) {
    faults.add(where, with_code(Code::conflicting_keys,
                                "key 'episodes': reset: node '{}' cannot begin anew, because {}; "
                                "leave it out, or write  reset: all  for all nodes that can",
                                name, why));
  }
}

/// Only a robot in this process can begin anew.
void check_episodes(const ExperimentFile& file, const Experiment& experiment, Faults& faults) {
  if (!experiment.episodes) {
    return;
  }
  const Location where = where_of(file, "episodes");
  const auto& reset = experiment.episodes->reset;
  for (auto name = reset.begin(); name != reset.end(); ++name) {
    if (std::find(reset.begin(), name, *name) != name) {
      faults.add(where, with_code(Code::duplicate_name,
                                  "key 'episodes': reset: node '{}' is listed twice; leave one out",
                                  *name));
    } else {
      check_reset(*name, file, experiment, faults);
    }
  }
  const bool acts = std::ranges::any_of(experiment.nodes,
                                        [](const Node& node) { return node.kind == kRosCommand; });
  const auto& robot = experiment.robot;
  if (experiment.episodes->count && !experiment.duration && !acts) {
    faults.add(where, with_code(Code::conflicting_keys,
                                "key 'episodes': the run would never end, because no node acts; "
                                "add a ros_command, or write a duration"));
  } else if (!robot || robot->model || !robot->bag.empty() || experiment.ros != Ros::none) {
    faults.add(where, with_code(Code::conflicting_keys,
                                "key 'episodes': only the vehicle and environments have episodes, "
                                "without ROS; leave it out, or write for example  robot: "
                                "{environment: mountain_car}"));
  } else if (experiment.episodes->pause_observation && !robot->environment) {
    faults.add(where, with_code(Code::conflicting_keys,
                                "key 'episodes': pause_observation is for an environment; leave it "
                                "out"));
  } else if (robot->environment &&
             (experiment.episodes->collision_reward || !experiment.episodes->goal.empty())) {
    faults.add(where, with_code(Code::conflicting_keys,
                                "key 'episodes': collision_reward and goal are for the vehicle; "
                                "leave them out"));
  }
}

/// Ways to run that exclude each other.
void check_ways(const Experiment& experiment, Faults& faults) {
  if (experiment.ros != Ros::none) {
    return;
  }
  if (experiment.sync == Sync::sim_time) {
    faults.add(
        experiment.sync_where,
        with_code(Code::conflicting_keys,
                  "key 'sync': sim_time follows the topic /clock, and there is no ROS; write  "
                  "ros: 2,  or  sync: lockstep  for the robot in this process"));
  } else if (experiment.sync == Sync::lockstep && !experiment.robot) {
    faults.add(experiment.sync_where,
               with_code(Code::conflicting_keys,
                         "key 'sync': lockstep has no robot to step; write  robot: "
                         "{simulator: mujoco},  ros: 2  for a robot that can be stepped "
                         "(docs/stepping.md), or  sync: unpaced"));
  }
}

/// An encoder that needs more memory than the machine has would be killed at its first tick.
void check_spike_rates(const Experiment& experiment, Faults& faults) {
  constexpr const char* kKey = "rate_max";
  constexpr double kMostSpikes = 1e8;  // per tick
  for (const Output& output : experiment.outputs) {
    const Node& node = experiment.node(output.node);
    const bool has_rate = node.role == Role::node &&
                          std::ranges::any_of(node.node_class->description.parameters,
                                              [](const auto& known) { return known.name == kKey; });
    if (output.kind != PortKind::spikes || !has_rate) {
      continue;
    }
    const double rate_hz = node.parameters.number(kKey);
    const double spikes = output.width * rate_hz * to_seconds(experiment.tick);
    if (spikes > kMostSpikes) {
      faults.add(node.parameters.where(kKey),
                 with_code(Code::out_of_bounds,
                           "node '{}': key '{}': {} channels of {} Hz send up to {} spikes "
                           "per tick of {}, which need {} GB; at most {} spikes: write a "
                           "lower {}, fewer channels, or a shorter tick",
                           node.name, kKey, output.width, rate_hz, format_rounded(spikes, 3),
                           format_time(experiment.tick),
                           format_rounded(spikes * sizeof(Spike) / 1e9, 3), kMostSpikes, kKey));
    }
  }
}

}  // namespace

Sync sync_named(std::string_view name) {
  for (const Sync sync : {Sync::unpaced, Sync::lockstep, Sync::sim_time}) {
    if (name_of(sync) == name) {
      return sync;
    }
  }
  return Sync::realtime;
}

Ros ros_named(std::string_view name) {
  return name == "1" ? Ros::ros1 : name == "2" ? Ros::ros2 : Ros::none;
}

std::string name_of(Ros ros) {
  return ros == Ros::none ? "none" : ros == Ros::ros1 ? "1" : "2";
}

messages::Dialect dialect_of(Ros ros) {
  return ros == Ros::ros2 ? messages::Dialect::ros2 : messages::Dialect::ros1;
}

std::string_view name_of(Sync sync) {
  switch (sync) {
    case Sync::realtime:
      return "realtime";
    case Sync::unpaced:
      return "unpaced";
    case Sync::lockstep:
      return "lockstep";
    case Sync::sim_time:
      break;
  }
  return "sim_time";
}

std::string file_of_user(const Experiment& experiment) {
  return std::filesystem::absolute(experiment.origin).lexically_normal().string();
}

std::string directory_of(const std::string& experiment_path) {
  const auto parent = std::filesystem::path(experiment_path).parent_path();
  return parent.empty() ? "." : parent.string();
}

const Node& Experiment::node(std::string_view wanted) const {
  for (const Node& candidate : nodes) {
    if (candidate.name == wanted) {
      return candidate;
    }
  }
  throw std::logic_error("there is no such node");
}

std::uint32_t Experiment::width(std::string_view node, std::string_view port) const {
  const std::string end = fmt::format("{}.{}", node, port);
  for (const Output& output : outputs) {
    if (output.node == node && output.port == port) {
      return output.width;
    }
  }
  std::uint32_t of_senders = 0;
  for (const Connection& connection : connections) {
    if (connection.to == end) {
      const std::uint32_t count = connection.channels.count(connection.width);
      of_senders = connection.combination == Combination::added ? count : of_senders + count;
    }
  }
  return of_senders;
}

/// Of the run that is repeated: they may have been written by hand.
void check_changes(const Experiment& experiment, const std::string& path) {
  for (const Change& change : experiment.changes) {
    const auto node = std::ranges::find(experiment.nodes, change.node, &Node::name);
    const bool known = node != experiment.nodes.end() && node->role == Role::node;
    const auto* parameters = known ? &node->node_class->description.parameters : nullptr;
    const auto fits = [&](const ParameterDescription& parameter) {
      return parameter.name == change.parameter && parameter.changeable &&
             change.value >= parameter.minimum && change.value <= parameter.maximum;
    };
    if (!known || std::ranges::none_of(*parameters, fits)) {
      throw ConfigurationError(
          {path, 0, 0},
          with_code(Code::out_of_bounds,
                    "'{}' is no change that this experiment can make: the node, a parameter that "
                    "may change, or the bounds of its value are others now",
                    to_text(change)));
    }
  }
}

Experiment resolve(const ExperimentFile& file, const NodeTypes& types, const Overrides& overrides,
                   Diagnostics& faults, const LookAtRobot& look_at_robot) {
  Faults all(faults);
  Experiment experiment;
  experiment.path = file.path;
  experiment.origin = origin_of(file, overrides);
  experiment.settings = overrides.settings;
  const Parameters keys = read_keys(file, experiment, all);
  RobotView robot = read_robot(file, overrides, look_at_robot, experiment, all);
  const auto bag = open_bag(experiment, all);
  experiment.dialect = bag ? bag->dialect() : dialect_of(experiment.ros);
  if (bag) {
    experiment.robot->recording = bag;
    robot.width = bag_width(bag);
  }
  check_ways(experiment, all);
  bool joined = file.joined;
  std::set<std::string> whole;
  const std::string directory = directory_of(experiment.origin);
  for (const ExperimentNode& entry : file.nodes) {
    const Checked checked = resolve_node(entry, types, directory, experiment, all);
    joined = joined && checked.ports;
    if (checked.parameters) {
      whole.insert(entry.name);
    }
  }
  check_topics(experiment, robot.topics, whole, all);
  if (bag && !overrides.replay) {
    check_bag(*bag, whole, experiment, all);
  }
  if (joined) {
    const std::size_t before = all.count();
    const ExperimentFile named = with_simulator_ports(file, experiment, all);
    if (all.count() == before) {
      Trial trial{whole, overrides.try_nodes, robot.width};
      if (bag) {
        trial.length_changes = [&](const Node& sensor) { return length_changes(*bag, sensor); };
      }
      resolve_connections(named, trial, experiment, all);
    }
  } else if (!faults.empty() && std::ranges::all_of(faults, [](const Diagnostic& fault) {
               return fault.exit_code == 0;  // code that was not run
             })) {
    all.add(
        NotRun("connections are not checked: the ports of a node of code are known when it runs"));
  }
  resolve_layout(keys, file.joined, experiment, all);
  if (faults.empty()) {
    check_spike_rates(experiment, all);
  }
  expand_reset(experiment);
  if (!overrides.replay) {
    check_episodes(file, experiment, all);
  } else if (experiment.episodes && !experiment.episodes->reset.empty()) {
    all.add(where_of(file, "episodes"),
            with_code(Code::conflicting_keys,
                      "key 'episodes': a run in which nodes are reset cannot be replayed, "
                      "because a recording has no episodes; repeat it with  spikeloop run FOLDER"));
  }
  if (!overrides.changes.empty() && faults.empty()) {
    experiment.changes = read_changes(overrides.changes);
    check_changes(experiment, overrides.changes);
  }
  std::ranges::stable_sort(faults, {}, [](const Diagnostic& fault) {
    return std::pair(fault.where.line, fault.where.column);
  });
  return experiment;
}

}  // namespace spikeloop::experiment
