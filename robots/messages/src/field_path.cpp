#include "spikeloop/messages/field_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "path_walk.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

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
      const auto dot = end_of_part(rest);
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
      if (type == nullptr && !is_time(field->primitive)) {
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
    throw ConfigurationError(with_code(Code::field_path, "field path '{}' of {}: {}", path_.text,
                                       path_.type->name, message));
  }

  /// The next '.' that is not in a selector's text; npos when there is none.
  static std::size_t end_of_part(std::string_view rest) {
    const auto bracket = rest.find('[');
    const auto dot = rest.find('.');
    return bracket < dot ? rest.find('.', std::min(rest.find(']', bracket), rest.size())) : dot;
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
        fail(
            fmt::format("'{}' is not an array; write it without '{}'", name, part.substr(bracket)));
      }
      parse_brackets(type, *found, part.substr(bracket), step);
    }
    check_bounds(*found, step);
    path_.steps.push_back(step);
    if (path_.width().value_or(0) > kMostElements) {
      fail_too_many(path_.text);
    }
    return *found;
  }

  void parse_brackets(const TypeLayout& type, const FieldLayout& field, std::string_view brackets,
                      PathStep& step) const {
    const std::string_view inside = brackets.size() > 2 && brackets.back() == ']'
                                        ? brackets.substr(1, brackets.size() - 2)
                                        : std::string_view{};
    const auto equals = inside.find('=');
    if (inside.empty() || equals == 0 || equals + 1 == inside.size()) {
      fail_selection(brackets);
    }
    if (equals == std::string_view::npos) {
      parse_elements(brackets, inside, step);
    } else {
      step.last = 1;
      step.selector =
          make_selector(type, field, inside.substr(0, equals), inside.substr(equals + 1));
    }
  }

  [[noreturn]] void fail_selection(std::string_view brackets) const {
    fail(fmt::format("'{}' selects nothing; write [index], [first:end] or [name=text]", brackets));
  }

  [[noreturn]] void fail_too_many(std::string_view brackets) const {
    fail(fmt::format("'{}' reaches beyond the first {} elements; no path takes more", brackets,
                     kMostElements));
  }

  Selector make_selector(const TypeLayout& type, const FieldLayout& field, std::string_view key,
                         std::string_view text) const {
    const auto find_key = [&](const TypeLayout& in, bool array) -> std::optional<std::size_t> {
      const auto found = std::ranges::find(in.fields, key, &FieldLayout::name);
      const bool fits = found != in.fields.end() && found->primitive == Primitive::text &&
                        (found->array != ArrayKind::none) == array;
      return fits ? std::optional(static_cast<std::size_t>(found - in.fields.begin()))
                  : std::nullopt;
    };
    if (field.message) {
      if (const auto within = find_key(*field.message, false)) {
        return {true, *within, std::string(text)};
      }
    }
    if (const auto beside = find_key(type, true)) {
      return {false, *beside, std::string(text)};
    }
    fail(
        fmt::format("'{0}' is neither a text in each element of '{1}' nor an array of texts "
                    "beside it, so [{0}={2}] selects nothing",
                    key, field.name, text));
  }

  void parse_elements(std::string_view brackets, std::string_view inside, PathStep& step) const {
    const auto elements = messages::parse_elements(inside);
    if (!elements) {
      fail_selection(brackets);
    }
    if (elements->is_too_far()) {
      fail_too_many(brackets);
    }
    if (elements->last <= elements->first) {
      fail(fmt::format("'{}' is empty; the end comes after the first element", brackets));
    }
    step.first = elements->first;
    step.last = elements->last;
  }

  void check_bounds(const FieldLayout& field, PathStep& step) const {
    if (step.selector) {
      return;
    }
    const std::size_t count = field.array == ArrayKind::none ? 1 : field.count;
    if (field.array == ArrayKind::variable) {
      if (count != 0 &&
          (step.first >= count || (step.last != PathStep::kEnd && step.last > count))) {
        fail(fmt::format("'{}' has at most {} elements; the first one is [0]", field.name, count));
      }
      return;
    }
    if (step.first >= count || (step.last != PathStep::kEnd && step.last > count)) {
      fail(fmt::format("'{}' has {} elements; the first one is [0]", field.name, count));
    }
    step.last = std::min(step.last, count);
  }

  void add_time_part(const FieldLayout& field, std::string_view part, bool more) {
    const bool is_seconds = part == "secs" || part == "sec";
    if (more || (!is_seconds && part != "nsecs" && part != "nanosec")) {
      const bool ros1 = path_.type->dialect == Dialect::ros1;
      fail(fmt::format("a time has no field '{0}'; write {1}.{2}, {1}.{3} or {1} (seconds)", part,
                       field.name, ros1 ? "secs" : "sec", ros1 ? "nsecs" : "nanosec"));
    }
    path_.time_part = is_seconds ? FieldPath::TimePart::secs : FieldPath::TimePart::nsecs;
  }

  FieldPath path_;
};

template <typename Reader>
double read_number(Reader& reader, const FieldPath& path, const FieldLayout& field) {
  if (path.time_part == FieldPath::TimePart::whole) {
    return reader.number(field.primitive);
  }
  const double seconds = reader.number(Reader::half_of_time(field.primitive, false));
  const double nanoseconds = reader.number(Reader::half_of_time(field.primitive, true));
  return path.time_part == FieldPath::TimePart::secs ? seconds : nanoseconds;
}

}  // namespace

std::optional<Elements> parse_elements(std::string_view inside) {
  const auto colon = inside.find(':');
  Elements elements;
  const auto parse = [](std::string_view digits, std::size_t& value) {
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value);
    return digits.empty() || (error == std::errc{} && stop == end);
  };
  const bool good =
      parse(inside.substr(0, colon), elements.first) &&
      (colon == std::string_view::npos || parse(inside.substr(colon + 1), elements.last));
  if (!good || inside.empty()) {
    return std::nullopt;
  }
  elements.has_end = colon + 1 != inside.size();
  if (colon == std::string_view::npos) {
    elements.last = elements.first + 1;
  }
  return elements;
}

const FieldLayout& FieldPath::field(std::size_t level) const {
  const TypeLayout* within = type.get();
  for (std::size_t i = 0; i < level; ++i) {
    within = within->fields[steps[i].field].message.get();
  }
  return within->fields[steps[level].field];
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
        with_code(Code::field_path,
                  "field path '{}' of {}: a text is not a number; name a field "
                  "with a number type",
                  path_.text, path_.type->name));
  }
}

std::size_t FieldReader::read(std::span<const std::byte> message,
                              std::vector<double>& values) const {
  const std::size_t before = values.size();
  walk_path(message, path_, [&](auto reader, const FieldLayout& field, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      values.push_back(read_number(reader, path_, field));
    }
  });
  return values.size() - before;
}

TextField::TextField(const Catalog& catalog, std::string_view type, std::string_view path)
    : path_(compile_path(catalog, type, path)) {
  if (!path_.is_text()) {
    throw ConfigurationError(
        with_code(Code::field_path,
                  "field path '{}' of {}: a number is not text; name a field of type string",
                  path_.text, path_.type->name));
  }
}

std::size_t TextField::read(std::span<const std::byte> message,
                            std::vector<std::string_view>& texts) const {
  const std::size_t before = texts.size();
  walk_path(message, path_, [&](auto reader, const FieldLayout&, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      texts.push_back(reader.text());
    }
  });
  return texts.size() - before;
}

}  // namespace spikeloop::messages
