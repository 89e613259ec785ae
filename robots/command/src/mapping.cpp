#include "spikeloop/command/mapping.hpp"

#include <utility>

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
    components.push_back(component);
  }
  return ComponentMap(std::move(components));
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
