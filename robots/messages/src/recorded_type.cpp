#include "spikeloop/messages/recorded_type.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "wire.hpp"

namespace spikeloop::messages {
namespace {

constexpr const char* kCutOff = "it is cut off";

bool is_same(const TypeLayout& theirs, const TypeLayout& ours);

/// The same bytes mean the same.
bool is_same(const FieldLayout& theirs, const FieldLayout& ours) {
  const bool is_fixed = ours.array == ArrayKind::fixed;
  return theirs.name == ours.name && theirs.primitive == ours.primitive &&
         theirs.array == ours.array && (!is_fixed || theirs.count == ours.count) &&
         (!ours.message || is_same(*theirs.message, *ours.message));
}

bool is_same(const TypeLayout& theirs, const TypeLayout& ours) {
  return std::ranges::equal(theirs.fields, ours.fields,
                            [](const auto& a, const auto& b) { return is_same(a, b); });
}

std::vector<std::string> names_from(const TypeLayout& type, std::size_t first) {
  std::vector<std::string> names;
  for (std::size_t i = first; i < type.fields.size(); ++i) {
    names.push_back(type.fields[i].name);
  }
  return names;
}

auto first_difference(const TypeLayout& theirs, const TypeLayout& ours) {
  return std::ranges::mismatch(theirs.fields, ours.fields,
                               [](const auto& a, const auto& b) { return is_same(a, b); });
}

/// True if a text that was cut off could have left this of our type.
bool is_cut(const TypeLayout& theirs, const TypeLayout& ours) {
  const auto [their, our] = first_difference(theirs, ours);
  if (their == theirs.fields.end() || our == ours.fields.end()) {
    return our != ours.fields.end();
  }
  if (their->message && our->message) {
    return their->name == our->name && is_cut(*their->message, *our->message);
  }
  return their + 1 == theirs.fields.end() && their->primitive == our->primitive &&
         our->name.starts_with(their->name);
}

Comparison compare_layouts(const TypeLayout& theirs, const TypeLayout& ours) {
  const auto [their, our] = first_difference(theirs, ours);
  if (their == theirs.fields.end()) {
    const auto count = static_cast<std::size_t>(our - ours.fields.begin());
    return {our == ours.fields.end() ? Fit::same : Fit::shorter, "", names_from(ours, count)};
  }
  if (our == ours.fields.end()) {
    return {Fit::longer};
  }
  if (is_cut(theirs, ours)) {
    return {Fit::unknown, kCutOff};
  }
  return {Fit::other, their->name == our->name
                          ? fmt::format("its field '{}' has another type", their->name)
                          : fmt::format("its field {} is '{}', ours is '{}'",
                                        their - theirs.fields.begin() + 1, their->name, our->name)};
}

std::string sum_of(const Catalog& catalog, std::string_view type) {
  return catalog.dialect() == Dialect::ros1 ? catalog.md5(type) : catalog.type_hash(type);
}

/// Reason for which the definition in a recording cannot be read; empty if there is none.
std::string reason_unreadable(const Schema& recorded, Dialect dialect) {
  const std::string_view usual = dialect == Dialect::ros1 ? kRos1Definition : kRos2Definition;
  return recorded.definition_encoding.empty() || recorded.definition_encoding == usual
             ? ""
             : fmt::format("it is in the format '{}'", recorded.definition_encoding);
}

std::string unreadable_line(const ConfigurationError& error) {
  return fmt::format("its line {} cannot be read", error.where().line);
}

/// The definition in the recording. @throws ConfigurationError
Catalog parse(const Schema& recorded, Dialect dialect, const std::string& type) {
  Catalog catalog(dialect);
  if (dialect == Dialect::ros2) {  // many programs leave these out
    for (const char* const name : {"builtin_interfaces/Time", "builtin_interfaces/Duration"}) {
      catalog.add(name, Catalog::builtin(dialect).find(name).text);
    }
  }
  catalog.add_with_dependencies(type, recorded.definition);
  return catalog;
}

[[noreturn]] void fail_definition(const RecordedTopic& recorded, std::string_view why) {
  throw ConfigurationError(with_code(Code::wrong_message,
                                     "topic '{}': the recording's definition of {} cannot be used, "
                                     "and Spikeloop has none that fits: {}",
                                     recorded.topic, recorded.type, why));
}

/// Compiles the recording's definition.
std::shared_ptr<const TypeLayout> written_layout(const RecordedTopic& recorded, Dialect dialect) {
  if (const std::string why = reason_unreadable(recorded.schema, dialect); !why.empty()) {
    fail_definition(recorded, why);
  }
  try {
    return parse(recorded.schema, dialect, recorded.type).layout(recorded.type);
  } catch (const ConfigurationError& error) {
    fail_definition(recorded, error.located() ? unreadable_line(error) : error.what());
  }
}

}  // namespace

Comparison compare_types(const Schema& recorded, std::string_view version, const Catalog& catalog,
                         std::string_view type) {
  const auto ours = catalog.layout(type);
  const std::string our_version = sum_of(catalog, type);
  if (version == our_version) {
    return {Fit::same};
  }
  if (recorded.definition.find_first_not_of(" \t\r\n") == std::string::npos &&
      !ours->fields.empty()) {
    return {Fit::unknown, "it is empty"};
  }
  if (std::string why = reason_unreadable(recorded, catalog.dialect()); !why.empty()) {
    return {Fit::unknown, std::move(why)};
  }
  try {
    const Catalog theirs = parse(recorded, catalog.dialect(), ours->name);
    if (catalog.dialect() == Dialect::ros1 && !version.empty() &&
        theirs.md5(ours->name) != version) {
      return {Fit::other, fmt::format("its md5 sum is {}, ours is {}", version, our_version)};
    }
    return compare_layouts(*theirs.layout(ours->name), *ours);
  } catch (const ConfigurationError& error) {
    return {Fit::unknown, error.located() ? unreadable_line(error) : kCutOff};
  }
}

Comparison compare_message(std::span<const std::byte> message, const TypeLayout& type) {
  constexpr std::size_t kPadding = 3;  // bytes that CDR may add
  try {
    return with_reader(type.dialect, message, [&](auto& reader) -> Comparison {
      const std::size_t padding = type.dialect == Dialect::ros2 ? kPadding : 0;
      for (std::size_t i = 0; i < type.fields.size(); ++i) {
        const std::size_t left = reader.left();
        try {
          skip_elements(reader, type.fields[i], read_count(reader, type.fields[i]));
        } catch (const TransportError&) {
          if (i > 0 && left <= padding) {
            return {Fit::shorter, "", names_from(type, i)};
          }
          throw;
        }
      }
      return {reader.left() > padding ? Fit::longer : Fit::same};
    });
  } catch (const TransportError& error) {
    return {Fit::other, error.what()};
  }
}

Comparison compare_recorded(const RecordedTopic& recorded, const Catalog& catalog) {
  Comparison found = compare_types(recorded.schema, recorded.version, catalog, recorded.type);
  if (!recorded.first || found.fit == Fit::other) {
    return found;
  }
  const Comparison bytes = compare_message(*recorded.first, *catalog.layout(recorded.type));
  if (found.fit == Fit::shorter && bytes.fit == Fit::same) {
    found = {Fit::unknown, "its messages have more fields"};
  }
  if (found.fit == Fit::unknown && bytes.fit == Fit::other) {
    return {Fit::other,
            fmt::format(
                "its definition cannot be used ({}), and its messages do not fit Spikeloop's ({})",
                found.detail, bytes.detail)};
  }
  found.missing = bytes.missing;
  return found;
}

std::string replacement_warning(const RecordedTopic& recorded, const Comparison& compared) {
  const bool has_definitions = !recorded.schema.encoding.empty();  // SQLite has some since Iron
  return compared.fit != Fit::unknown || !has_definitions
             ? ""
             : fmt::format(
                   "topic '{}': the recording's definition of {} cannot be used ({}); Spikeloop's "
                   "own is used",
                   recorded.topic, recorded.type, compared.detail);
}

RecordedLayout layout_of(const RecordedTopic& recorded, Dialect dialect) {
  RecordedLayout result;
  const Catalog& own = Catalog::builtin(dialect);
  if (own.contains(recorded.type)) {
    const Comparison compared = compare_recorded(recorded, own);
    if (compared.fit == Fit::same || compared.fit == Fit::unknown) {
      result.type = own.layout(recorded.type);
    }
    if (std::string warning = replacement_warning(recorded, compared); !warning.empty()) {
      result.warnings.push_back(std::move(warning));
    }
  }
  if (!result.type) {
    result.type = written_layout(recorded, dialect);
  }
  if (!recorded.first) {
    return result;
  }
  const Comparison bytes = compare_message(*recorded.first, *result.type);
  if (bytes.fit == Fit::shorter) {
    auto shorter = std::make_shared<TypeLayout>(*result.type);
    shorter->fields.resize(shorter->fields.size() - bytes.missing.size());
    shorter->bytes.reset();
    result.type = std::move(shorter);
  } else if (bytes.fit == Fit::longer && result.type->fields.empty()) {
    fail_definition(recorded, "it is empty");
  } else if (bytes.fit == Fit::longer) {
    result.warnings.push_back(
        fmt::format("topic '{}': the messages have more bytes than the definition of {} in the "
                    "recording describes; fields after '{}' are left out",
                    recorded.topic, recorded.type, result.type->fields.back().name));
  }
  return result;
}

}  // namespace spikeloop::messages
