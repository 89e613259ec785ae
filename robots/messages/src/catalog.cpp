#include "spikeloop/messages/catalog.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/types.h>

#include <md5.h>

#include <algorithm>

#include "embedded.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/number.hpp"

namespace spikeloop::messages {
namespace {

constexpr std::string_view kHeadline = "MSG: ";

/// Bytes of a number or a time; for a text, bytes of its length.
std::size_t size_of(Primitive primitive) {
  if (primitive == Primitive::text) {
    return sizeof(std::uint32_t);
  }
  return is_time(primitive) ? 2 * sizeof(std::uint32_t)
                            : with_number(primitive, [](auto type) { return sizeof type; });
}

std::size_t alignment_of(Primitive primitive, Dialect dialect) {
  return dialect == Dialect::ros1 ? 1 : is_time(primitive) ? 4 : size_of(primitive);
}

FieldLayout layout_of(const FieldDefinition& field, std::shared_ptr<const TypeLayout> message,
                      Dialect dialect) {
  FieldLayout layout;
  layout.name = field.name;
  layout.primitive = field.primitive;
  layout.array = field.array;
  layout.count = field.count;
  layout.longest_text = field.longest_text;
  layout.otherwise = field.otherwise;
  if (message) {
    layout.element_bytes = message->bytes;
    layout.alignment = message->alignment;
    layout.element_least = message->least;
  } else {
    layout.element_least = size_of(field.primitive);
    layout.alignment = alignment_of(field.primitive, dialect);
    if (field.primitive != Primitive::text) {
      layout.element_bytes = layout.element_least;
    }
  }
  layout.message = std::move(message);
  return layout;
}

/// A type is without gaps when all in it is aligned alike, and a multiple of that long.
void append_field(TypeLayout& type, FieldLayout field) {
  const bool constant = field.array != ArrayKind::variable && field.element_bytes.has_value();
  const bool alike = type.fields.empty() || field.alignment == type.alignment;
  const std::size_t count = field.array == ArrayKind::fixed ? field.count : 1;
  type.least += field.array == ArrayKind::variable ? 4 : count * field.element_least;
  if (constant && alike && type.bytes) {
    *type.bytes += count * *field.element_bytes;
    type.alignment = field.alignment;
  } else {
    type.bytes.reset();
  }
  if (type.least > kLargestMessage) {
    throw ConfigurationError(with_code(
        Code::message_definition,
        "message type '{}' is longer than 1 GB with its field '{}'; write a shorter array",
        type.name, field.name));
  }
  type.fields.push_back(std::move(field));
}

Catalog builtin_of(Dialect dialect) {
  Catalog catalog(dialect);
  for (const EmbeddedDefinition& definition : embedded_definitions(dialect)) {
    catalog.add(definition.name, definition.text);
  }
  return catalog;
}

std::string unknown_type(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string meant = nearest(name, candidates);
  return with_code(
      Code::unknown_message, "unknown message type '{}'; {}", name,
      meant.empty() ? "write one that 'spikeloop describe --messages' lists, or the path of a .msg "
                      "file"
                    : fmt::format("did you mean '{}'?", meant));
}

}  // namespace

std::string without_msg(std::string_view name) {
  std::string plain(name);
  for (auto colons = plain.find("::"); colons != std::string::npos; colons = plain.find("::")) {
    plain.replace(colons, 2, "/");
  }
  if (const auto folder = plain.find("/msg/"); folder != std::string::npos) {
    plain.erase(folder, 4);
  }
  return plain;
}

const Catalog& Catalog::builtin(Dialect dialect) {
  static const Catalog ros1 = builtin_of(Dialect::ros1);
  static const Catalog ros2 = builtin_of(Dialect::ros2);
  return dialect == Dialect::ros1 ? ros1 : ros2;
}

void Catalog::add(std::string_view name, std::string_view text) {
  Definition definition = parse_definition(name, text, dialect_);
  definitions_.insert_or_assign(std::string(name), std::move(definition));
}

void Catalog::add_with_dependencies(std::string_view name, std::string_view full_text) {
  std::string current(name);
  std::string text;
  std::size_t begin = 0;
  while (begin < full_text.size()) {
    const auto end = std::min(full_text.find('\n', begin), full_text.size());
    const std::string_view line = full_text.substr(begin, end - begin);
    const std::string_view bare = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    begin = end + 1;
    if (bare.size() >= 3 && bare.find_first_not_of('=') == std::string_view::npos) {
      continue;
    }
    if (bare.starts_with(kHeadline)) {
      add(current, text);
      current = without_msg(bare.substr(kHeadline.size()));
      text.clear();
      continue;
    }
    text += line;
    text += '\n';
  }
  add(current, text);
}

bool Catalog::contains(std::string_view name) const {
  return definitions_.contains(name);
}

std::vector<std::string> Catalog::names() const {
  std::vector<std::string> names;
  names.reserve(definitions_.size());
  for (const auto& [name, definition] : definitions_) {
    names.push_back(name);
  }
  return names;
}

const Definition& Catalog::find(std::string_view name) const {
  const auto found = definitions_.find(without_msg(name));
  if (found == definitions_.end()) {
    throw ConfigurationError(unknown_type(name, names()));
  }
  return found->second;
}

std::string Catalog::full_name(std::string_view name) const {
  if (const auto file = files_.find(name); file != files_.end()) {
    return file->second;
  }
  if (name.find('/') != std::string_view::npos) {
    return find(name).name;
  }
  std::vector<std::string> matches;
  std::vector<std::string> short_names;
  for (const auto& [full, definition] : definitions_) {
    short_names.push_back(full.substr(full.find('/') + 1));
    if (short_names.back() == name) {
      matches.push_back(full);
    }
  }
  if (matches.size() > 1) {
    throw ConfigurationError(with_code(Code::unknown_message,
                                       "message type '{}' is in several packages; write one of {}",
                                       name, fmt::join(matches, ", ")));
  }
  if (matches.empty()) {
    throw ConfigurationError(unknown_type(name, short_names));
  }
  return matches.front();
}

const Definition& Catalog::part(const Definition& whole, const FieldDefinition& field) const {
  const auto found = definitions_.find(field.type);
  if (found == definitions_.end()) {
    throw ConfigurationError(with_code(Code::unknown_message,
                                       "message type '{}' needs '{}' for its field '{}', which is "
                                       "not known; add its definition too",
                                       whole.name, field.type, field.name));
  }
  return found->second;
}

std::string Catalog::md5(std::string_view name) const {
  layout(name);  // refuses messages that contain themselves
  const Definition& definition = find(name);
  std::string text;
  for (const ConstantDefinition& constant : definition.constants) {
    text += fmt::format("{} {}={}\n", constant.type, constant.name, constant.value);
  }
  for (const FieldDefinition& field : definition.fields) {
    const bool is_message = field.primitive == Primitive::message;
    text += fmt::format(
        "{} {}\n", is_message ? md5(part(definition, field).name) : field.written_type, field.name);
  }
  if (!text.empty()) {
    text.pop_back();
  }
  char hex[MD5_DIGEST_STRING_LENGTH];
  return MD5Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), hex);
}

std::string Catalog::full_text(std::string_view name) const {
  layout(name);
  std::string text;
  std::vector<std::string> done;
  const auto visit = [&](const auto& self, const Definition& definition) -> void {
    if (std::ranges::find(done, definition.name) != done.end()) {
      return;
    }
    if (!done.empty()) {
      text += fmt::format("\n{:=<80}\n{}{}\n", "", kHeadline, definition.name);
    }
    text += definition.text;
    done.push_back(definition.name);
    for (const FieldDefinition& field : definition.fields) {
      if (field.type.find('/') != std::string::npos) {
        self(self, part(definition, field));
      }
    }
  };
  visit(visit, find(name));
  return text;
}

struct Catalog::Walk {
  struct Known {
    std::shared_ptr<const TypeLayout> layout;
    std::size_t fields = 0;  ///< with those of its parts
  };
  std::vector<std::string> within;
  std::map<std::string, Known, std::less<>> known;
};

std::shared_ptr<const TypeLayout> Catalog::layout(std::string_view name) const {
  Walk walk;
  return layout(name, walk);
}

std::shared_ptr<const TypeLayout> Catalog::layout(std::string_view name, Walk& walk) const {
  constexpr std::size_t kDeepest = 64;
  constexpr std::size_t kMostFields = 20'000;
  const Definition& definition = find(name);
  if (const auto known = walk.known.find(definition.name); known != walk.known.end()) {
    return known->second.layout;
  }
  const bool inside_itself = std::ranges::find(walk.within, definition.name) != walk.within.end();
  walk.within.push_back(definition.name);
  if (inside_itself) {
    throw ConfigurationError(
        with_code(Code::message_definition,
                  "message type '{}' contains itself: {}; take the field out that leads back", name,
                  fmt::join(walk.within, " -> ")));
  }
  if (walk.within.size() > kDeepest) {
    throw ConfigurationError(with_code(Code::message_definition,
                                       "message type '{}' has more than {} messages inside of "
                                       "each other; write a flatter one",
                                       walk.within.front(), kDeepest));
  }
  auto type = std::make_shared<TypeLayout>();
  type->name = definition.name;
  type->dialect = dialect_;
  type->bytes = 0;
  if (dialect_ == Dialect::ros2 && definition.fields.empty()) {
    type->bytes = type->least = 1;  // IDL knows no empty structure: an octet stands in it
  }
  std::size_t fields = definition.fields.size();
  for (const FieldDefinition& field : definition.fields) {
    std::shared_ptr<const TypeLayout> message;
    if (field.primitive == Primitive::message) {
      message = layout(part(definition, field).name, walk);
      fields += walk.known.find(message->name)->second.fields;
    }
    append_field(*type, layout_of(field, std::move(message), dialect_));
    if (fields > kMostFields) {
      throw ConfigurationError(with_code(Code::message_definition,
                                         "message type '{}' has more than {} fields, with those "
                                         "of its parts; write an array instead",
                                         definition.name, kMostFields));
    }
  }
  walk.within.pop_back();
  walk.known[definition.name] = {type, fields};
  return type;
}

}  // namespace spikeloop::messages
