#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <set>

#include "faults.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/graph_plan.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"

namespace spikeloop::experiment {
namespace {

constexpr std::uint32_t kMostTicks = 1'000'000;

[[noreturn]] void refuse_delay(const WrittenValue& written, const std::string& reason) {
  throw ConfigurationError(written.where,
                           with_code(Code::delay, "delay '{}' {}", written.text, reason));
}

/// "2 ticks", "1 tick", "2ticks"; not a number: something else than a count stands before the unit.
std::optional<double> whole_ticks(const std::string& text) {
  constexpr std::string_view kBlank = " \t";
  std::string_view number = text;
  if (!number.ends_with("tick") && !number.ends_with("ticks")) {
    return std::nullopt;
  }
  number.remove_suffix(number.ends_with("s") ? 5 : 4);
  number = number.substr(0, number.find_last_not_of(kBlank) + 1);
  std::uint32_t count = 0;
  const char* const end = number.data() + number.size();
  const auto parsed = std::from_chars(number.data(), end, count);
  return parsed.ec == std::errc() && parsed.ptr == end ? count : std::nan("");
}

std::uint32_t delay_ticks(const WrittenValue& written, TimeNs tick) {
  if (written.text == "0") {
    return 0;  // needs no unit
  }
  std::optional<double> ticks = whole_ticks(written.text);
  if (!ticks) {
    try {
      ticks = parse_quantity(written.text, "s") / to_seconds(tick);
    } catch (const ConfigurationError& error) {
      refuse_delay(written, fmt::format("is not a delay: {}; write for example 5 ms or 2 ticks",
                                        error.what()));
    }
    if (written.text.find_first_not_of("0123456789.+-eE") == std::string::npos) {
      refuse_delay(written, fmt::format("has no unit; write {0} ms or {0} ticks", written.text));
    }
  }
  const double rounded = std::round(*ticks);
  if (!(rounded >= 0 && rounded <= kMostTicks) || std::fabs(*ticks - rounded) > 1e-6) {
    refuse_delay(written, fmt::format("is not a whole number of ticks from 0 to {}; write a "
                                      "multiple of the tick, {}",
                                      kMostTicks, format_time(tick)));
  }
  return static_cast<std::uint32_t>(rounded);
}

/// Nodes that no connection names; none as long as a connection has a slip in a name.
std::set<std::string> lonely_nodes(const ExperimentFile& file, const Experiment& experiment) {
  std::set<std::string> lonely;
  for (const Node& node : experiment.nodes) {
    lonely.insert(node.name);
  }
  const std::set<std::string> known = lonely;
  for (const ExperimentConnection& connection : file.connections) {
    for (const std::string& name : {node_of(connection.from), node_of(connection.to)}) {
      lonely.erase(name);
      if (!known.contains(name)) {
        return {};
      }
    }
  }
  return lonely;
}

/// A sensor may be there to be recorded, where the robot says how many channels it has.
bool may_stand_alone(const Node& node, const Experiment& experiment) {
  return takes_messages(node.kind) && experiment.robot;
}

GraphDescription as_nodes(const ExperimentFile& file, const Experiment& experiment,
                          Faults& faults) {
  GraphDescription description;
  description.tick = experiment.tick;
  description.seed = experiment.seed;
  const auto lonely = lonely_nodes(file, experiment);
  for (const Node& node : experiment.nodes) {
    if (lonely.contains(node.name) && !may_stand_alone(node, experiment)) {
      faults.add(node.where, with_code(Code::not_connected,
                                       "node '{0}' is not connected; write it into "
                                       "'connections', or leave it out",
                                       node.name));
    } else {
      description.nodes.push_back({node.name, node.node_class, node.parameters, node.where});
    }
  }
  for (const ExperimentConnection& connection : file.connections) {
    std::uint32_t ticks = 0;
    if (!connection.delay.text.empty() && !faults.attempt(connection.where, [&] {
          ticks = delay_ticks(connection.delay, experiment.tick);
        })) {
      ticks = 1;  // something was meant: a cycle that it is part of has a delay
    }
    description.connections.push_back({.from = connection.from,
                                       .to = connection.to,
                                       .width = connection.width,
                                       .delay_ticks = ticks,
                                       .where = connection.where,
                                       .where_from = connection.where_from,
                                       .channels = connection.channels,
                                       .combination = connection.combination});
  }
  return description;
}

void take_connections(const GraphPlan& plan, const ExperimentFile& file,
                      const GraphDescription& graph, Experiment& experiment) {
  for (std::size_t i = 0; i < plan.connections.size(); ++i) {
    const PlannedConnection& planned = plan.connections[i];
    Connection connection{plan.text(planned.from),
                          plan.text(planned.to),
                          plan.port(planned.from).kind,
                          plan.port(planned.from).width,
                          std::nullopt,
                          planned.where,
                          planned.channels,
                          planned.combination};
    if (!file.connections[i].delay.text.empty()) {
      connection.delay_ticks = graph.connections[i].delay_ticks;
    }
    experiment.connections.push_back(connection);
  }
  for (const PlannedElement& element : plan.elements) {
    for (const PlannedPort& port : element.ports) {
      if (port.direction == Direction::output) {
        experiment.outputs.push_back({element.name, port.name, port.kind, port.width});
      }
    }
  }
}

messages::SensorConversion sensor_conversion(const Node& node, const Experiment& experiment,
                                             bool strict) {
  const std::string& type = node.parameters.text("message");
  return {messages::Catalog::for_type(experiment.dialect, type), type,
          sensing::sensor_rule(node.parameters), experiment.width(node.name, "out"), strict};
}

/// True if a connection may have another number of channels than the message: messages of changing
/// length, except images, are read as far as they fit, and a default position fills the port.
bool may_differ(const Node& node, const Experiment& experiment, const Trial& trial) {
  if (node.kind != kRosSensor || takes_picture(node.parameters)) {
    return false;
  }
  return (trial.length_changes && trial.length_changes(node)) ||
         sensor_conversion(node, experiment, false).width() == experiment.width(node.name, "out");
}

void check_against_robot(const Node& node, const Experiment& experiment, const Trial& trial) {
  std::uint32_t values = 0;
  try {
    values = trial.sensor_width ? trial.sensor_width(node).value_or(0) : 0;
  } catch (const Error&) {
    if (!experiment.robot || experiment.robot->bag.empty()) {
      throw;
    }
    // The run reports a message of a recording that cannot be read.
  }
  for (const Connection& connection : experiment.connections) {
    if (node_of(connection.from) == node.name && values != 0 && values != connection.width &&
        !may_differ(node, experiment, trial)) {
      throw ConfigurationError(
          connection.where,
          with_code(
              Code::fields_differ,
              "node '{}': a message of the {}'s topic {} gives {} values, but '{}' has {} "
              "channels; write [{}] in its connection{}{}",
              node.name, experiment.robot->bag.empty() ? "robot" : "bag",
              node.parameters.text("topic"), values, connection.from, connection.width, values,
              takes_picture(node.parameters) && !experiment.robot->bag.empty()
                  ? ", or " + sensor_conversion(node, experiment, false).length_remedy()
                  : "",
              experiment.ros == Ros::none ? ""
                                          : ", or leave 'robot' out when another robot sends it"));
    }
  }
}

/// A camera without a region says how many pixels it has when its first message comes.
void check_events(const Node& node, const Experiment& experiment) {
  messages::EventSettings settings = event_settings(node.parameters);
  for (const Connection& connection : experiment.connections) {
    if (node_of(connection.from) == node.name) {
      settings.width = connection.width;
      settings.where = connection.where;
      messages::EventConversion(settings, experiment.dialect);
    }
  }
}

/// A sensor that nothing takes, whose message does not say how many channels it has either.
[[noreturn]] void refuse_width(const Node& node) {
  throw ConfigurationError(
      node.where,
      with_code(Code::unknown_width,
                "node '{}': nothing says how many channels it has; connect it, with the "
                "number of channels",
                node.name));
}

/// What only widths decide.
void check_node(const Node& node, const Experiment& experiment, const Trial& trial) {
  if (takes_messages(node.kind) && experiment.width(node.name, "out") == 0) {
    if (trial.sensor_width) {  // else the robot is faulty, which has been told
      refuse_width(node);
    }
  } else if (node.kind == kRosSensor) {
    check_against_robot(node, experiment, trial);
    located_at(sensing::place_of_rule(node.parameters),
               [&] { return sensor_conversion(node, experiment, true); });
  } else if (node.kind == kRosEventSensor) {
    check_against_robot(node, experiment, trial);
    check_events(node, experiment);
  } else if (node.kind == kRosCommand) {
    in_yaml([&] { check_channels(node.mapping, experiment.width(node.name, "in")); });
    if (spike_timeout(node) != 0 && spikes_behind(experiment, node.name).empty()) {
      throw ConfigurationError(
          node.parameters.where("spike_timeout"),
          with_code(Code::conflicting_keys,
                    "key 'spike_timeout': no spikes are on the way to '{}'; leave it out",
                    node.name));
    }
  }
}

bool is_unknown_width(const ConfigurationError& error) {
  return std::string_view(error.what())
      .ends_with(fmt::format("[{}]", code_text(Code::unknown_width)));
}

/// Makes the node once: it says whether its parameters go with its widths.
void try_node(const Node& node, const PlannedElement& element, std::uint64_t seed) {
  if (node.role != Role::node) {
    return;
  }
  NodeSetup setup{node.name, seed, node.parameters, {}};
  for (const PlannedPort& port : element.ports) {
    if (port.width == 0) {
      throw ConfigurationError(
          node.where, with_code(Code::not_connected,
                                "nothing is connected to the output '{}.{}', and nothing else says "
                                "how wide it is; connect it, or leave the node out",
                                node.name, port.name));
    }
    setup.widths.push_back(port.width);
  }
  node.node_class->create(setup);
}

}  // namespace

void resolve_connections(const ExperimentFile& file, const Trial& trial, Experiment& experiment,
                         Faults& faults) {
  const std::size_t before = faults.count();
  GraphDescription graph = as_nodes(file, experiment, faults);
  GraphPlan planned;
  bool has_unknown_widths = false;
  faults.attempt(file.where_connections, [&] {
    std::vector<ConfigurationError> wrong;
    const ErrorHandler keep = [&](const ConfigurationError& error) { wrong.push_back(error); };
    planned = plan(graph, keep);
    if (settle_by_nodes(planned, trial, graph, experiment, faults)) {
      wrong.clear();
      planned = plan(graph, keep);
    }
    if (experiment.robot && faults.count() != 0) {
      // The width is unknown because of a sensor error that has been reported.
      has_unknown_widths = std::erase_if(wrong, is_unknown_width) > 0;
    }
    for (const ConfigurationError& error : wrong) {
      faults.attempt(file.where_connections, [&] { throw error; });
    }
  });
  if (has_unknown_widths || faults.count() != before) {
    return;
  }
  take_connections(planned, file, graph, experiment);
  for (std::size_t i = 0; i < experiment.nodes.size(); ++i) {
    const Node& node = experiment.nodes[i];
    if (trial.whole.contains(node.name)) {
      faults.attempt(node.where, [&] {
        check_node(node, experiment, trial);
        if (trial.try_nodes) {
          try_node(node, planned.elements[i], experiment.seed);
        }
      });
    }
  }
}

}  // namespace spikeloop::experiment
