// Widths that neither a connection nor a neighbour says, but a node's own table or message.
#include <algorithm>
#include <map>

#include "faults.hpp"
#include "spikeloop/experiment/endpoints.hpp"

namespace spikeloop::experiment {
namespace {

constexpr const char* kGrid = "grid";  // of place cells: their centres, then their widths

/// A row an output and a column an input, as all tables have it. 0: it has no size.
std::uint32_t table_width(const Part& part, Direction direction) {
  const NodeDescription& node = part.node_class->description;
  const auto ports = std::ranges::count(node.ports, direction, &PortDescription::direction);
  const auto is_table = [](const auto& parameter) {
    return parameter.type == ParameterType::weights;
  };
  const auto table = std::ranges::find_if(node.parameters, is_table);
  if (ports != 1 || table == node.parameters.end() ||
      std::ranges::count_if(node.parameters, is_table) != 1) {
    return 0;
  }
  const WeightTable& weights = part.parameters.weights(table->name);
  return direction == Direction::output ? weights.rows
         : table->name == kGrid         ? weights.columns / 2
                                        : weights.columns;
}

/// A picture of a size that is written says its width.
std::uint32_t sensor_width(const Part& part, const Trial& trial) {
  const messages::SensorRule rule = sensor_rule(part.parameters);
  if (rule.image && rule.image->values()) {
    return *rule.image->values();
  }
  return trial.sensor_width ? trial.sensor_width(part).value_or(0) : 0;
}

/// So does a region of a camera.
std::uint32_t event_width(const Part& part, const Trial& trial) {
  const messages::EventSettings settings = event_settings(part.parameters);
  if (settings.region) {
    return static_cast<std::uint32_t>(
        messages::event_channels(settings, settings.region->width, settings.region->height));
  }
  return trial.sensor_width ? trial.sensor_width(part).value_or(0) : 0;
}

std::uint32_t known_width(const Part& part, Direction direction, const Trial& trial) {
  if (part.kind == kRosSensor) {
    return trial.whole.contains(part.name) ? sensor_width(part, trial) : 0;
  }
  if (part.kind == kRosEventSensor) {
    return trial.whole.contains(part.name) ? event_width(part, trial) : 0;
  }
  return table_width(part, direction);
}

}  // namespace

bool settle_by_nodes(const GraphPlan& plan, const Trial& trial, GraphDescription& graph,
                     Experiment& experiment) {
  std::map<std::string_view, Part*> parts;
  for (Part& part : experiment.parts) {
    parts[part.name] = &part;
  }
  bool any = false;
  for (std::size_t i = 0; i < plan.elements.size(); ++i) {
    const auto& ports = plan.elements[i].ports;
    Part& part = *parts.at(plan.elements[i].name);
    for (std::size_t p = 0; p < ports.size(); ++p) {
      const bool open = ports[p].width == 0 && ports[p].rule.kind == WidthRule::Kind::free;
      const std::uint32_t width = open ? known_width(part, ports[p].direction, trial) : 0;
      if (width != 0) {
        auto own = std::make_shared<NodeClass>(*part.node_class);
        own->description.ports[p].width = WidthRule::fixed(width);
        part.node_class = graph.nodes[i].node_class = own.get();
        experiment.own_classes.push_back(std::move(own));
        any = true;
      }
    }
  }
  return any;
}

}  // namespace spikeloop::experiment
