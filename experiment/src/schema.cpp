#include "spikeloop/experiment/schema.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/core/units.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/images/image_settings.hpp"

namespace spikeloop::experiment {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSimulator = "a simulator";  // no class can be named so
constexpr const char* kDigits = R"((\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)";

Json reference(const std::string& name) {
  return {{"$ref", "#/definitions/" + name}};
}

Json list_of(Json items) {
  return {{"type", "array"}, {"items", std::move(items)}};
}

Json with_bounds(Json schema, const ParameterDescription& parameter) {
  if (std::isfinite(parameter.minimum)) {
    schema["minimum"] = parameter.minimum;
  }
  if (std::isfinite(parameter.maximum)) {
    schema["maximum"] = parameter.maximum;
  }
  return schema;
}

/// A number with a unit is a text for YAML; of its bounds, a pattern knows the sign alone. Zero
/// needs no unit.
Json quantity(const ParameterDescription& parameter) {
  std::string units;
  for (const std::string& unit : units_like(parameter.unit)) {
    units += (units.empty() ? "" : "|") + unit;
  }
  const char* sign = parameter.minimum >= 0 ? "\\+?" : "[+-]?";
  return {{"anyOf",
           {{{"type", "string"}, {"pattern", fmt::format("^{}{} *({})$", sign, kDigits, units)}},
            {{"const", 0}}}}};
}

/// YAML 1.1 takes 1e-3 for a text.
Json plain_number(const ParameterDescription& parameter) {
  return {{"anyOf",
           {with_bounds({{"type", "number"}}, parameter),
            {{"type", "string"}, {"pattern", fmt::format("^[+-]?{}$", kDigits)}}}}};
}

/// "1" is a number for YAML when it is not quoted.
Json choice(const ParameterDescription& parameter) {
  Json values = Json::array();
  for (const std::string& value : parameter.choices) {
    values.push_back(value);
    if (!value.empty() && value.find_first_not_of("0123456789") == std::string::npos) {
      values.push_back(std::stoll(value));
    }
  }
  return {{"enum", values}};
}

Json of_type(const ParameterDescription& parameter) {
  switch (parameter.type) {
    case ParameterType::number:
      return units_like(parameter.unit).empty() ? plain_number(parameter) : quantity(parameter);
    case ParameterType::integer:
      return with_bounds({{"type", "integer"}}, parameter);
    case ParameterType::boolean:
      return {{"type", "boolean"}};
    case ParameterType::choice:
      return choice(parameter);
    case ParameterType::weights:
      return reference("weights");
    case ParameterType::text:
      break;
  }
  return {{"type", {"string", "number", "boolean"}}};
}

std::string description_of(const ParameterDescription& parameter) {
  const auto& value = parameter.default_value;
  std::string text = parameter.text;
  if (!value) {
    text += " (must be given)";
  } else if (!value->empty()) {
    text += fmt::format(" (default: {})", *value);
  }
  return text;
}

Json property(const ParameterDescription& parameter) {
  Json schema = of_type(parameter);
  schema["description"] = description_of(parameter);
  return schema;
}

Json object_of(const std::vector<ParameterDescription>& parameters) {
  Json properties = Json::object();
  Json required = Json::array();
  for (const ParameterDescription& parameter : parameters) {
    properties[parameter.name] = property(parameter);
    if (!parameter.default_value) {
      required.push_back(parameter.name);
    }
  }
  return {{"type", "object"},
          {"properties", properties},
          {"required", required},
          {"additionalProperties", false}};
}

Json weights() {
  const Json row = list_of({{"type", "number"}});
  Json entry = row;
  entry["minItems"] = entry["maxItems"] = 3;
  const Json size{{"type", "integer"}, {"minimum", 1}};
  return {{"anyOf",
           {{{"type", "string"},
             {"description", "A file, JSON or NumPy's, or uniform, one_to_one, blocks"}},
            {{"type", "array"}, {"minItems", 1}, {"items", row}},
            {{"type", "object"},
             {"properties", {{"rows", size}, {"columns", size}, {"entries", list_of(entry)}}},
             {"required", {"rows", "columns", "entries"}},
             {"additionalProperties", false}}}}};
}

Json rate() {
  return {{"type", "number"}, {"exclusiveMinimum", 0}};
}

/// {linear.x: 0, angular.z: {channel: 1, scale: 2}}
Json command_fields() {
  const Json number{{"type", "number"}};
  const Json channel{{"type", "integer"}, {"minimum", 0}};
  const Json field{{"type", "object"},
                   {"properties",
                    {{"channel", channel},
                     {"scale", number},
                     {"offset", number},
                     {"min", number},
                     {"max", number},
                     {"slew", rate()}}},
                   {"required", {"channel"}},
                   {"additionalProperties", false}};
  return {{"type", "object"}, {"additionalProperties", {{"anyOf", {channel, field}}}}};
}

/// [ranges, {path: ranges, scale: 2}]
Json sensor_fields() {
  const Json number{{"type", "number"}};
  Json range = list_of(number);
  range["minItems"] = range["maxItems"] = 2;
  const Json field{{"type", "object"},
                   {"properties",
                    {{"path", {{"type", "string"}}},
                     {"scale", number},
                     {"offset", number},
                     {"min", number},
                     {"max", number},
                     {"range", range},
                     {"nan", {{"anyOf", {number, {{"enum", {"pass", "hold", "skip", "zero"}}}}}}}}},
                   {"required", {"path"}},
                   {"additionalProperties", false}};
  const Json path{{"type", "string"}};
  return {{"anyOf", {path, list_of({{"anyOf", {path, field}}})}}};
}

/// {resize: [40, 30], filter: on_off}
Json image() {
  Json schema = object_of(images::image_parameters());
  for (const auto& [key, count] : {std::pair("crop", 4), {"resize", 2}, {"range", 2}}) {
    Json list = list_of({{"type", "number"}});
    list["minItems"] = list["maxItems"] = count;
    list["description"] = schema["properties"][key]["description"];
    schema["properties"][key] = list;
  }
  return schema;
}

/// [x, y, width, height]
Json region() {
  Json list = list_of({{"type", "integer"}, {"minimum", 0}});
  list["minItems"] = list["maxItems"] = 4;
  return list;
}

Json limits() {
  Json pair = list_of({{"type", "number"}});
  pair["minItems"] = pair["maxItems"] = 2;
  return {
      {"anyOf", {{{"const", kNoLimits}}, {{"type", "object"}, {"additionalProperties", pair}}}}};
}

Json slew() {
  return {{"type", "object"}, {"additionalProperties", rate()}};
}

/// A topic, none, or a map that has more to say of it.
Json topic_or(const std::vector<ParameterDescription>& parameters) {
  return {{"anyOf", {{{"type", "string"}}, object_of(parameters)}}};
}

Json network() {
  const Json map{{"type", "object"}};
  return {{"type", "object"},
          {"properties",
           {{"resolution", {{"type", {"string", "number", "boolean"}}}},
            {"populations", map},
            {"connections", list_of(map)},
            {"output", list_of({{"type", "string"}})},
            {"potential", list_of({{"type", "string"}})},
            {"record", map}}},
          {"required", {"populations"}},
          {"additionalProperties", false}};
}

/// Texts in the declarations that may be lists or maps in a file.
void put_structures(const std::string& kind, Json& properties) {
  const auto put = [&](const char* key, Json schema) {
    schema["description"] = properties[key]["description"];
    properties[key] = std::move(schema);
  };
  if (kind == kRosSensor) {
    put("fields", sensor_fields());
    put("image", image());
  } else if (kind == kRosEventSensor) {
    put("roi", region());
  } else if (kind == kRosCommand) {
    put("fields", command_fields());
    put("limits", limits());
    put("slew", slew());
    put("emergency_stop", topic_or(emergency_stop_parameters()));
    put("override", topic_or(override_parameters()));
  } else if (kind == kNetwork) {
    put("network", {{"anyOf", {{{"type", "string"}}, network()}}});
  }
}

Json class_key(const NodeDescription& description) {
  return {{"const", description.name}, {"description", description.text}};
}

Json kind(const NodeDescription& description) {
  Json schema = object_of(description.parameters);
  put_structures(description.name, schema["properties"]);
  schema["properties"]["node"] = class_key(description);
  if (description.name == kNetwork) {
    schema["properties"]["simulator"] = {{"const", "builtin"}};
  }
  return schema;
}

/// A script's parameters are its own.
Json simulator() {
  Json schema = object_of(simulator_description().parameters);
  schema["additionalProperties"] = true;
  return schema;
}

Json if_then(const char* key, const std::string& value, const std::string& definition) {
  return {{"if", {{"properties", {{key, {{"const", value}}}}}, {"required", {key}}}},
          {"then", reference(definition)}};
}

/// `node` or `simulator` decides what else there may be.
Json node(const std::vector<std::string>& names) {
  Json cases = Json::array();
  Json simulating{"builtin"};
  cases.push_back(if_then("simulator", "builtin", kNetwork));
  for (const Simulator& simulator : simulators()) {
    simulating.push_back(simulator.name);
    cases.push_back(if_then("simulator", simulator.name, kSimulator));
  }
  for (const std::string& name : names) {
    cases.push_back(if_then("node", name, name));
  }
  return {{"type", "object"},
          {"properties",
           {{"node", {{"enum", names}, {"description", "Its class: spikeloop describe"}}},
            {"simulator",
             {{"enum", simulating},
              {"description", "builtin: node: network; or what a script of yours runs"}}}}},
          {"oneOf", {{{"required", {"node"}}}, {{"required", {"simulator"}}}}},
          {"allOf", cases}};
}

Json connections() {
  const std::string end = R"([A-Za-z0-9_]+(\.[A-Za-z0-9_]+)?)";
  const std::string station = fmt::format(R"( *{}( *\[[^\[\]]*\])? *)", end);
  Json map = object_of(connection_parameters());
  map["properties"]["delay"]["pattern"] =
      fmt::format("^{} *(ticks?|{})$", kDigits, fmt::join(units_like("s"), "|"));
  map["properties"]["delay"]["type"] = "string";
  for (const char* key : {"from", "to"}) {
    map["properties"][key]["type"] = "string";
    map["properties"][key]["pattern"] = fmt::format("^{}$", end);
  }
  const Json line{{"type", "string"},
                  {"pattern", fmt::format("^ *{}( *->{})+$", end, station)},
                  {"description", "scan -> encoder [100] -> brain [100, delay 5 ms]"}};
  return {{"type", "array"},
          {"minItems", 1},
          {"items", {{"anyOf", {line, map}}}},
          {"description", "NODE -> NODE [width, delay 5 ms] -> ..."}};
}

}  // namespace

std::string json_schema(const Kinds& kinds) {
  Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
              {"title", "Spikeloop experiment"}};
  schema.update(object_of(experiment_parameters()));
  Json& properties = schema["properties"];
  properties["robot"] = object_of(robot_parameters());
  properties["robot"]["properties"]["camera"].update(object_of(camera_parameters()));
  properties["robot"]["description"] =
      "The robot that is simulated in this process, or a bag in its place";
  properties["robot"]["oneOf"] = {{{"required", {"simulator"}}},
                                  {{"required", {"bag"}}, {"maxProperties", 1}}};
  properties["plugins"] = list_of({{"type", "string"}});
  properties["plugins"]["description"] =
      "Files with more classes of nodes, from where this one lies";
  properties["nodes"] = {{"type", "object"},
                         {"minProperties", 1},
                         {"propertyNames", {{"pattern", "^[A-Za-z0-9_]+$"}}},
                         {"additionalProperties", reference("node")},
                         {"description", "NAME: {node: CLASS, key: value, ...}"}};
  properties["connections"] = connections();
  schema["required"] = {"nodes", "connections"};
  const auto names = kinds.names();
  Json& definitions = schema["definitions"];
  definitions["node"] = node(names);
  definitions["weights"] = weights();
  definitions[kSimulator] = simulator();
  for (const std::string& name : names) {
    definitions[name] = kind(kinds.find(name).description);
  }
  return schema.dump(2) + "\n";
}

}  // namespace spikeloop::experiment
