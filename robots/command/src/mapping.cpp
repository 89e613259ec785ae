#include "spikeloop/command/mapping.hpp"

#include <utility>

#include "spikeloop/command/default_bounds.hpp"

namespace spikeloop::command {

ComponentMap component_map(const CommandMapping& mapping, std::uint32_t width) {
  std::vector<Component> components;
  if (mapping.all_channels) {
    for (std::uint32_t channel = 0; channel < width; ++channel) {
      components.push_back({.channel = channel});
    }
  }
  for (const CommandField& field : mapping.fields) {
    Component component{.channel = field.channel, .scale = field.scale, .offset = field.offset};
    component.minimum = field.minimum.value_or(component.minimum);
    component.maximum = field.maximum.value_or(component.maximum);
    component.slew = field.slew.value_or(component.slew);
    components.push_back(component);
  }
  return ComponentMap(std::move(components));
}

std::vector<Bounds> default_bounds(const CommandMapping& mapping, std::vector<Bounds> bounds) {
  for (std::size_t i = 0; i < mapping.fields.size(); ++i) {
    const CommandField& field = mapping.fields[i];
    if (!field.minimum && !field.maximum) {
      const Bounds own = default_bounds(mapping.message_type, field.field);
      bounds[i].minimum = own.minimum;
      bounds[i].maximum = own.maximum;
    }
  }
  return bounds;
}

std::vector<std::string> field_paths(const CommandMapping& mapping) {
  if (mapping.all_channels) {
    return {"data"};
  }
  std::vector<std::string> paths;
  paths.reserve(mapping.fields.size());
  for (const CommandField& field : mapping.fields) {
    paths.push_back(field.field);
  }
  return paths;
}

}  // namespace spikeloop::command
