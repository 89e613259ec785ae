#include "spikeloop/experiment/schema.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/core/units.hpp"
#include "spikeloop/experiment/simulators.hpp"

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

/// "ns|[u\u00b5\u03bc]s|ms|s": both letters of micro are accepted, as by parse_quantity.
std::string units_pattern(std::string_view unit) {
  std::string pattern;
  for (const std::string& each : units_like(unit)) {
    pattern += pattern.empty() ? "" : "|";
    pattern += each.starts_with('u') ? "[u\u00b5\u03bc]" + each.substr(1) : each;
  }
  return pattern;
}

/// A number with a unit is a text for YAML; of its bounds, a pattern knows the sign alone. Zero
/// needs no unit.
Json quantity(const ParameterDescription& parameter) {
  const std::string units = units_pattern(parameter.unit);
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

Json of_type(const ParameterDescription& parameter);
Json object_of(const std::vector<ParameterDescription>& parameters);

Json list(const ParameterDescription& parameter) {
  Json schema = list_of(of_type(parameter.inner.front()));
  if (parameter.count != 0) {
    schema["minItems"] = schema["maxItems"] = parameter.count;
  }
  return parameter.choices.empty() ? schema : Json{{"anyOf", {choice(parameter), schema}}};
}

/// A map, or what may stand in its place.
Json map(const ParameterDescription& parameter) {
  const bool any_key = parameter.inner.front().name == kAnyKey;
  Json schema =
      any_key ? Json{{"type", "object"}, {"additionalProperties", of_type(parameter.inner.front())}}
              : object_of(parameter.inner);
  Json others = Json::array();
  if (!parameter.choices.empty()) {
    others.push_back(choice(parameter));
  }
  const auto plain =
      std::ranges::find(parameter.inner, parameter.plain_key, &ParameterDescription::name);
  if (plain != parameter.inner.end()) {
    others.push_back(of_type(*plain));
  }
  if (others.empty()) {
    return schema;
  }
  others.push_back(std::move(schema));
  return {{"anyOf", others}};
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
    case ParameterType::list:
      return list(parameter);
    case ParameterType::map:
      return map(parameter);
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
  Json axis = row;
  axis["minItems"] = axis["maxItems"] = 4;
  const Json size{{"type", "integer"}, {"minimum", 1}};
  return {
      {"anyOf",
       {{{"type", "string"}, {"description", "JSON or NumPy file, or uniform, one_to_one, blocks"}},
        {{"type", "array"}, {"minItems", 1}, {"items", row}},
        {{"type", "object"},
         {"properties", {{"rows", size}, {"columns", size}, {"entries", list_of(entry)}}},
         {"required", {"rows", "columns", "entries"}},
         {"additionalProperties", false}},
        {{"type", "object"},
         {"properties", {{"axes", list_of(axis)}}},
         {"required", {"axes"}},
         {"additionalProperties", false}}}}};
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
            {"rates", list_of({{"type", "string"}})},
            {"record", map}}},
          {"required", {"populations"}},
          {"additionalProperties", false}};
}

Json class_key(const NodeDescription& description) {
  return {{"const", description.name}, {"description", description.text}};
}

Json kind(const NodeDescription& description) {
  Json schema = object_of(description.parameters);
  Json& properties = schema["properties"];
  properties.update(object_of(node_parameters())["properties"]);
  properties["node"] = class_key(description);
  if (description.name == kNetwork) {
    properties["simulator"] = {{"const", "builtin"}};
    properties["network"]["anyOf"] = {{{"type", "string"}}, network()};
    properties["network"].erase("type");
    schema["additionalProperties"] = true;  // arguments of a Python function
  }
  return schema;
}

/// A script's parameters are its own.
Json simulator() {
  Json schema = object_of(simulator_description().parameters);
  schema["properties"].update(object_of(node_parameters())["properties"]);
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
  return {
      {"type", "object"},
      {"properties",
       {{"node", {{"enum", names}, {"description", "Node class; spikeloop describe lists all"}}},
        {"simulator",
         {{"enum", simulating},
          {"description", "builtin (node: network), or the simulator of a script"}}}}},
      {"oneOf", {{{"required", {"node"}}}, {{"required", {"simulator"}}}}},
      {"allOf", cases}};
}

Json connections() {
  const std::string end = R"([A-Za-z0-9_]+(\.[A-Za-z0-9_]+)?)";
  const std::string sender = end + R"((\[([0-9]+|[0-9]+:[0-9]*|:[0-9]+)\])?)";
  const std::string senders = fmt::format("{0}(( *, *{0})*|( *\\+ *{0})*)", sender);
  const std::string station = fmt::format(R"( *{}( *\[[^\[\]]*\])? *)", end);
  Json map = object_of(connection_parameters());
  map["properties"]["delay"]["pattern"] =
      fmt::format("^{} *(ticks?|{})$", kDigits, units_pattern("s"));
  map["properties"]["delay"]["type"] = "string";
  const auto text_like = [](const std::string& pattern) {
    return Json{{"type", "string"}, {"pattern", fmt::format("^{}$", pattern)}};
  };
  map["properties"]["to"].update(text_like(end));
  map["properties"]["from"].erase("type");
  map["properties"]["from"]["anyOf"] = {
      text_like(senders), {{"type", "array"}, {"minItems", 1}, {"items", text_like(sender)}}};
  const Json line{{"type", "string"},
                  {"pattern", fmt::format("^ *{}( *->{})+$", senders, station)},
                  {"description", "scan -> encoder [100] -> brain [100, delay 5 ms]"}};
  return {{"type", "array"},
          {"minItems", 1},
          {"items", {{"anyOf", {line, map}}}},
          {"description", "NODE -> NODE [width, delay 5 ms] -> ..."}};
}

}  // namespace

std::string json_schema(const NodeTypes& types) {
  Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
              {"title", "Spikeloop experiment"}};
  schema.update(object_of(experiment_parameters()));
  Json& properties = schema["properties"];
  properties["robot"] = object_of(robot_parameters());
  properties["robot"]["description"] =
      "Robot that is simulated in this process, or a bag that replaces it";
  properties["robot"]["oneOf"] = {{{"required", {"simulator"}}},
                                  {{"required", {"environment"}}},
                                  {{"required", {"bag"}}, {"maxProperties", 1}}};
  properties["plugins"] = list_of({{"type", "string"}});
  properties["plugins"]["description"] =
      "Files with further node classes; paths are relative to this file";
  properties["nodes"] = {{"type", "object"},
                         {"minProperties", 1},
                         {"propertyNames", {{"pattern", "^[A-Za-z0-9_]+$"}}},
                         {"additionalProperties", reference("node")},
                         {"description", "NAME: {node: CLASS, key: value, ...}"}};
  properties["connections"] = connections();
  schema["required"] = {"nodes", "connections"};
  const auto names = types.names();
  Json& definitions = schema["definitions"];
  definitions["node"] = node(names);
  definitions["weights"] = weights();
  definitions[kSimulator] = simulator();
  for (const std::string& name : names) {
    definitions[name] = kind(types.find(name).description);
  }
  return schema.dump(2) + "\n";
}

}  // namespace spikeloop::experiment
