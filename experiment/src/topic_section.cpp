#include "spikeloop/experiment/topic_section.hpp"

#include <algorithm>
#include <string>

#include "spikeloop/experiment/node_types.hpp"

namespace spikeloop::experiment {
namespace {

constexpr SectionKey kSensorKeys[] = {
    {"ros_topic", "topic"}, {"message_type", "message"}, {"fields", "fields"},  {"beams", "beams"},
    {"angles", "angles"},   {"range", "range"},          {"initial", "initial"}};

constexpr SectionKey kEventKeys[] = {{"ros_topic", "topic"},
                                     {"message_type", "message"},
                                     {"polarity", "polarity"},
                                     {"downsample", "downsample"},
                                     {"roi", "roi"},
                                     {"latency", "latency"},
                                     {"refractory", "refractory"}};

// The mapping file says the message, the fields and their limits.
constexpr SectionKey kCommandKeys[] = {{"ros_topic", "topic"},
                                       {"command_rate", "command_rate"},
                                       {"deadband", "deadband"},
                                       {"min_interval", "min_interval"},
                                       {"watchdog", "watchdog"},
                                       {"max_age", "max_age"},
                                       {"joint_states", "joint_states"},
                                       {"guard_required", "guard_required"},
                                       {"emergency_stop", "emergency_stop", "topic"},
                                       {"emergency_stop_message", "emergency_stop", "message"},
                                       {"emergency_stop_field", "emergency_stop", "field"},
                                       {"emergency_stop_latched", "emergency_stop", "latched"},
                                       {"emergency_stop_required", "emergency_stop", "required"},
                                       {"emergency_stop_timeout", "emergency_stop", "timeout"},
                                       {"override", "override", "topic"},
                                       {"override_timeout", "override", "timeout"}};

const std::vector<ParameterDescription>& parameters_of(const RosProgram& program) {
  return topic_class(program.node_class).description.parameters;
}

const ParameterDescription& declaration(const std::vector<ParameterDescription>& parameters,
                                        std::string_view name) {
  return *std::ranges::find(parameters, name, &ParameterDescription::name);
}

/// What the older program took for a parameter; empty: what the class takes.
std::string_view older_default(const RosProgram& program, const SectionKey& key) {
  if (!key.inner.empty()) {
    return "";
  }
  return key.parameter == "topic"          ? program.topic
         : key.parameter == "message"      ? program.message
         : key.parameter == "command_rate" ? program.command_rate
                                           : "";
}

void copy(const Parameters& from, const std::string& name, Parameters& to, const std::string& as) {
  if (const auto value = from.all().find(name); value != from.all().end()) {
    to.set(as, value->second, from.given(name), from.where(name));
  }
}

/// A map of which the section has one key an entry.
void add_map(const std::string& name, const Parameters& section, std::span<const SectionKey> keys,
             Parameters& result) {
  Parameters inner;
  Location where;
  bool given = false;
  for (const SectionKey& key : keys) {
    if (key.parameter == name) {
      copy(section, std::string(key.name), inner, std::string(key.inner));
      if (section.given(key.name) && !given) {
        given = true;
        where = section.where(key.name);
      }
    }
  }
  result.set(name, Parameters::Entries{{"", where, std::move(inner)}}, given, where);
}

}  // namespace

std::span<const SectionKey> section_keys(std::string_view node_class) {
  if (node_class == kRosSensor) {
    return kSensorKeys;
  }
  if (node_class == kRosEventSensor) {
    return kEventKeys;
  }
  return kCommandKeys;
}

const NodeClass& topic_class(std::string_view node_class) {
  static const NodeTypes kTypes;
  return kTypes.find(node_class);
}

std::vector<ParameterDescription> section_parameters(const RosProgram& program) {
  std::vector<ParameterDescription> result;
  for (const SectionKey& key : section_keys(program.node_class)) {
    ParameterDescription parameter = declaration(parameters_of(program), key.parameter);
    if (!key.inner.empty()) {
      const std::vector<ParameterDescription> inner = parameter.inner;
      parameter = declaration(inner, key.inner);
    }
    parameter.name = key.name;
    if (const auto older = older_default(program, key); !older.empty()) {
      parameter.default_value = older;
    }
    result.push_back(std::move(parameter));
  }
  return result;
}

Parameters class_parameters(const RosProgram& program, const Parameters& section) {
  const auto keys = section_keys(program.node_class);
  Parameters result;
  for (ParameterDescription parameter : parameters_of(program)) {
    const auto key = std::ranges::find(keys, parameter.name, &SectionKey::parameter);
    if (key == keys.end()) {
      parameter.default_value = parameter.default_value.value_or("");
      copy(spikeloop::resolve({parameter}, {}, {}), parameter.name, result, parameter.name);
    } else if (key->inner.empty()) {
      copy(section, std::string(key->name), result, parameter.name);
    } else {
      add_map(parameter.name, section, keys, result);
    }
  }
  return result;
}

}  // namespace spikeloop::experiment
