// The type hash of REP 2016: SHA-256 of the type's description as JSON, without default values,
// constants and comments.
#include <fmt/format.h>
#include <sys/types.h>

#include <sha2.h>

#include <map>
#include <stdexcept>

#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::messages {
namespace {

constexpr std::string_view kNoFields =
    R"({"name": "structure_needs_at_least_one_member", "type": {"type_id": 3, "capacity": 0, )"
    R"("string_capacity": 0, "nested_type_name": ""}})";

// The numbers of type_description_interfaces/FieldType.
constexpr int kNested = 1;
constexpr int kByte = 16;
constexpr int kText = 17;
constexpr int kBoundedText = 21;
constexpr int kArray = 48;
constexpr int kBoundedSequence = 96;
constexpr int kSequence = 144;
constexpr int kNumbers[] = {15, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};  // in the order of Primitive

/// "sensor_msgs/msg/LaserScan"
std::string idl_name(const std::string& name) {
  const auto slash = name.find('/');
  return name.substr(0, slash) + "/msg" + name.substr(slash);
}

bool is_nested(const FieldDefinition& field) {
  return field.type.find('/') != std::string::npos;
}

int element_type_id(const FieldDefinition& field) {
  if (is_nested(field)) {
    return kNested;
  }
  if (field.type == "byte") {
    return kByte;
  }
  if (field.primitive == Primitive::text) {
    return field.longest_text == 0 ? kText : kBoundedText;
  }
  return kNumbers[static_cast<std::size_t>(field.primitive)];
}

int type_id(const FieldDefinition& field) {
  switch (field.array) {
    case ArrayKind::fixed:
      return element_type_id(field) + kArray;
    case ArrayKind::variable:
      return element_type_id(field) + (field.count == 0 ? kSequence : kBoundedSequence);
    default:
      return element_type_id(field);
  }
}

std::string describe_fields(const Definition& definition) {
  if (definition.fields.empty()) {
    return std::string(kNoFields);
  }
  std::string text;
  for (const FieldDefinition& field : definition.fields) {
    text += fmt::format(
        R"({}{{"name": "{}", "type": {{"type_id": {}, "capacity": {}, "string_capacity": {}, )"
        R"("nested_type_name": "{}"}}}})",
        text.empty() ? "" : ", ", field.name, type_id(field), field.count, field.longest_text,
        is_nested(field) ? idl_name(field.type) : "");
  }
  return text;
}

std::string describe_type(const Definition& definition) {
  return fmt::format(R"({{"type_name": "{}", "fields": [{}]}})", idl_name(definition.name),
                     describe_fields(definition));
}

}  // namespace

std::string Catalog::type_hash(std::string_view name) const {
  if (dialect_ != Dialect::ros2) {
    throw std::logic_error("only ROS 2 has type hashes");
  }
  layout(name);  // refuses messages that contain themselves
  const Definition& whole = find(name);
  std::map<std::string, std::string> parts;  // by their names, which orders them
  const auto visit = [&](const auto& self, const Definition& definition) -> void {
    for (const FieldDefinition& field : definition.fields) {
      if (is_nested(field) && !parts.contains(field.type)) {
        const Definition& nested = part(definition, field);
        parts.emplace(field.type, describe_type(nested));
        self(self, nested);
      }
    }
  };
  visit(visit, whole);
  std::string referenced;
  for (const auto& [type, description] : parts) {
    referenced += (referenced.empty() ? "" : ", ") + description;
  }
  const std::string text =
      fmt::format(R"({{"type_description": {}, "referenced_type_descriptions": [{}]}})",
                  describe_type(whole), referenced);
  char hex[SHA256_DIGEST_STRING_LENGTH];
  return std::string("RIHS01_") +
         SHA256Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), hex);
}

}  // namespace spikeloop::messages
