#include "spikeloop/messages/field_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "spikeloop/core/error.hpp"
#include "wire.hpp"

namespace spikeloop::messages {
namespace {

bool is_time(const FieldLayout& field) {
  return field.primitive == Primitive::time || field.primitive == Primitive::duration;
}

class Compiler {
 public:
  Compiler(const Catalog& catalog, std::string_view type, std::string_view path) {
    path_.text = path;
    path_.type = catalog.layout(catalog.full_name(type));
  }

  FieldPath compile() {
    const TypeLayout* type = path_.type.get();
    std::string_view rest = path_.text;
    const FieldLayout* field = nullptr;
    while (true) {
      const auto dot = rest.find('.');
      const std::string_view part = rest.substr(0, dot);
      if (type == nullptr) {
        add_time_part(*field, part, dot != std::string_view::npos);
        break;
      }
      field = &add_step(*type, part);
      type = field->message.get();
      if (dot == std::string_view::npos) {
        break;
      }
      if (type == nullptr && !is_time(*field)) {
        fail(fmt::format("'{}' is a single value without fields; end the path there", field->name));
      }
      rest = rest.substr(dot + 1);
    }
    if (type != nullptr) {
      fail(fmt::format("'{}' is a {}, no number; go on with one of its fields: {}", field->name,
                       type->name, field_names(*type)));
    }
    return std::move(path_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw ConfigurationError(
        fmt::format("field path '{}' of {}: {}", path_.text, path_.type->name, message));
  }

  static std::string field_names(const TypeLayout& type) {
    std::string names;
    for (const FieldLayout& field : type.fields) {
      names += (names.empty() ? "" : ", ") + field.name;
    }
    return names;
  }

  const FieldLayout& add_step(const TypeLayout& type, std::string_view part) {
    const auto bracket = part.find('[');
    const std::string_view name = part.substr(0, bracket);
    const auto found = std::ranges::find(type.fields, name, &FieldLayout::name);
    if (found == type.fields.end()) {
      std::vector<std::string> names;
      names.reserve(type.fields.size());
      for (const FieldLayout& field : type.fields) {
        names.push_back(field.name);
      }
      fail(fmt::format("{} has no field '{}'{}", type.name, name, did_you_mean(name, names)));
    }
    PathStep step;
    step.field = static_cast<std::size_t>(found - type.fields.begin());
    if (bracket != std::string_view::npos) {
      if (found->array == ArrayKind::none) {
        fail(fmt::format("'{}' is no array; write it without '{}'", name, part.substr(bracket)));
      }
      parse_elements(part.substr(bracket), step);
    }
    check_bounds(*found, step);
    path_.steps.push_back(step);
    return *found;
  }

  void parse_elements(std::string_view brackets, PathStep& step) const {
    const std::string_view inside = brackets.size() > 2 && brackets.back() == ']'
                                        ? brackets.substr(1, brackets.size() - 2)
                                        : std::string_view{};
    const auto colon = inside.find(':');
    const auto number = [&](std::string_view digits, std::size_t otherwise) {
      std::size_t value = otherwise;
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (!digits.empty() && (error != std::errc{} || end != digits.data() + digits.size())) {
        fail(fmt::format("'{}' selects nothing; write [index] or [first:end]", brackets));
      }
      return value;
    };
    if (inside.empty()) {
      fail(fmt::format("'{}' selects nothing; write [index] or [first:end]", brackets));
    }
    step.first = number(inside.substr(0, colon), 0);
    step.last = colon == std::string_view::npos ? step.first + 1
                                                : number(inside.substr(colon + 1), PathStep::kEnd);
    if (step.last <= step.first) {
      fail(fmt::format("'{}' is empty; the end comes after the first element", brackets));
    }
  }

  void check_bounds(const FieldLayout& field, PathStep& step) const {
    const std::size_t count = field.array == ArrayKind::none ? 1 : field.count;
    if (field.array == ArrayKind::variable) {
      return;
    }
    if (step.first >= count || (step.last != PathStep::kEnd && step.last > count)) {
      fail(fmt::format("'{}' has {} elements; the first one is [0]", field.name, count));
    }
    step.last = std::min(step.last, count);
  }

  void add_time_part(const FieldLayout& field, std::string_view part, bool more) {
    if (more || (part != "secs" && part != "nsecs")) {
      fail(fmt::format("a time has no field '{}'; write {}.secs, {}.nsecs or {} (seconds)", part,
                       field.name, field.name, field.name));
    }
    path_.time_part = part == "secs" ? FieldPath::TimePart::secs : FieldPath::TimePart::nsecs;
  }

  FieldPath path_;
};

double read_number(Ros1Reader& reader, const FieldPath& path, const FieldLayout& field) {
  if (!is_time(field) || path.time_part == FieldPath::TimePart::whole) {
    return reader.number(field.primitive);
  }
  const bool is_signed = field.primitive == Primitive::duration;
  const Primitive half = is_signed ? Primitive::int32 : Primitive::uint32;
  const double seconds = reader.number(half);
  const double nanoseconds = reader.number(half);
  return path.time_part == FieldPath::TimePart::secs ? seconds : nanoseconds;
}

void read_level(Ros1Reader& reader, const FieldPath& path, const TypeLayout& type,
                std::size_t level, std::vector<double>& values) {
  const PathStep& step = path.steps[level];
  for (std::size_t i = 0; i < step.field; ++i) {
    skip_elements(reader, type.fields[i], read_count(reader, type.fields[i]));
  }
  const FieldLayout& field = type.fields[step.field];
  const std::size_t last = std::min(read_count(reader, field), step.last);
  if (step.first >= last) {
    return;
  }
  skip_elements(reader, field, step.first);
  for (std::size_t i = step.first; i < last; ++i) {
    if (level + 1 == path.steps.size()) {
      values.push_back(read_number(reader, path, field));
      continue;
    }
    Ros1Reader inside = reader;
    read_level(inside, path, *field.message, level + 1, values);
    if (i + 1 < last) {
      skip_element(reader, field);
    }
  }
}

}  // namespace

const FieldLayout& FieldPath::target() const {
  const TypeLayout* within = type.get();
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    within = within->fields[steps[i].field].message.get();
  }
  return within->fields[steps.back().field];
}

std::optional<std::size_t> FieldPath::width() const {
  std::size_t width = 1;
  for (const PathStep& step : steps) {
    if (step.last == PathStep::kEnd) {
      return std::nullopt;
    }
    width *= step.last - step.first;
  }
  return width;
}

FieldPath compile_path(const Catalog& catalog, std::string_view type, std::string_view path) {
  return Compiler(catalog, type, path).compile();
}

FieldReader::FieldReader(const Catalog& catalog, std::string_view type, std::string_view path)
    : path_(compile_path(catalog, type, path)) {
  if (path_.is_text()) {
    throw ConfigurationError(
        fmt::format("field path '{}' of {}: a text is no number; name a field "
                    "with a number type",
                    path_.text, path_.type->name));
  }
}

std::size_t FieldReader::read(std::span<const std::byte> message,
                              std::vector<double>& values) const {
  Ros1Reader reader(message);
  const std::size_t before = values.size();
  read_level(reader, path_, *path_.type, 0, values);
  return values.size() - before;
}

}  // namespace spikeloop::messages
