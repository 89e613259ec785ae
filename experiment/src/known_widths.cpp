// Widths that neither a connection nor a neighbour says, but a node's own table or message.
#include <algorithm>
#include <map>

#include "faults.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"

namespace spikeloop::experiment {
namespace {

constexpr const char* kGrid = "grid";  // of place cells: their centres, then their widths

/// A row an output and a column an input, as all tables have it. 0: it has no size.
std::uint32_t table_width(const Node& node, Direction direction) {
  const NodeDescription& known = node.node_class->description;
  const auto ports = std::ranges::count(known.ports, direction, &PortDescription::direction);
  const auto is_table = [](const auto& parameter) {
    return parameter.type == ParameterType::weights;
  };
  const auto table = std::ranges::find_if(known.parameters, is_table);
  if (ports != 1 || table == known.parameters.end() ||
      std::ranges::count_if(known.parameters, is_table) != 1) {
    return 0;
  }
  const WeightTable& weights = node.parameters.weights(table->name);
  return direction == Direction::output ? weights.rows
         : table->name == kGrid         ? weights.columns / 2
                                        : weights.columns;
}

/// Number of values of the fields that are read; 0 if the message determines it.
std::uint32_t width_of_fields(const Node& node, const messages::SensorRule& rule,
                              messages::Dialect dialect) {
  const std::string& type = node.parameters.text("message");
  const auto width = located_at(sensing::place_of_rule(node.parameters), [&] {
    const auto& catalog = messages::Catalog::for_type(dialect, type);
    return messages::SensorConversion(catalog, type, rule, 0, false).width();
  });
  return static_cast<std::uint32_t>(width.value_or(0));
}

/// The size of an image and the number of directions of a scan may be written.
std::uint32_t sensor_width(const Node& node, const Trial& trial, messages::Dialect dialect) {
  const messages::SensorRule rule = sensing::sensor_rule(node.parameters);
  if (rule.image && rule.image->values()) {
    return *rule.image->values();
  }
  if (rule.scan && rule.scan->beams != 0) {
    return rule.scan->beams;
  }
  const std::uint32_t sent = trial.sensor_width ? trial.sensor_width(node).value_or(0) : 0;
  return sent != 0 ? sent : width_of_fields(node, rule, dialect);
}

/// So does a region of a camera.
std::uint32_t event_width(const Node& node, const Trial& trial) {
  const messages::EventSettings settings = event_settings(node.parameters);
  if (settings.region) {
    return static_cast<std::uint32_t>(
        messages::event_channels(settings, settings.region->width, settings.region->height));
  }
  return trial.sensor_width ? trial.sensor_width(node).value_or(0) : 0;
}

std::uint32_t known_width(const Node& node, Direction direction, const Trial& trial,
                          messages::Dialect dialect) {
  if (node.kind == kRosSensor) {
    return trial.whole.contains(node.name) ? sensor_width(node, trial, dialect) : 0;
  }
  if (node.kind == kRosEventSensor) {
    return trial.whole.contains(node.name) ? event_width(node, trial) : 0;
  }
  return table_width(node, direction);
}

}  // namespace

bool settle_by_nodes(const GraphPlan& plan, const Trial& trial, GraphDescription& graph,
                     Experiment& experiment, Faults& faults) {
  std::map<std::string_view, Node*> nodes;
  for (Node& node : experiment.nodes) {
    nodes[node.name] = &node;
  }
  bool any = false;
  for (std::size_t i = 0; i < plan.elements.size(); ++i) {
    const auto& ports = plan.elements[i].ports;
    Node& node = *nodes.at(plan.elements[i].name);
    for (std::size_t p = 0; p < ports.size(); ++p) {
      const bool open = ports[p].width == 0 && ports[p].rule.kind == WidthRule::Kind::free;
      std::uint32_t width = 0;
      if (open) {
        faults.attempt(node.where, [&] {
          width = known_width(node, ports[p].direction, trial, experiment.dialect);
        });
      }
      if (width != 0) {
        auto own = std::make_shared<NodeClass>(*node.node_class);
        own->description.ports[p].width = WidthRule::fixed(width);
        node.node_class = graph.nodes[i].node_class = own.get();
        experiment.own_classes.push_back(std::move(own));
        any = true;
      }
    }
  }
  return any;
}

}  // namespace spikeloop::experiment
