#include "spikeloop/messages/definition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "literal.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::messages {
namespace {

constexpr std::pair<std::string_view, Primitive> kPrimitives[] = {
    {"bool", Primitive::boolean},  {"int8", Primitive::int8},       {"uint8", Primitive::uint8},
    {"char", Primitive::uint8},    {"int16", Primitive::int16},     {"uint16", Primitive::uint16},
    {"int32", Primitive::int32},   {"uint32", Primitive::uint32},   {"int64", Primitive::int64},
    {"uint64", Primitive::uint64}, {"float32", Primitive::float32}, {"float64", Primitive::float64},
    {"string", Primitive::text},
};

constexpr std::pair<std::string_view, Primitive> kRos1Primitives[] = {
    {"byte", Primitive::int8},
    {"time", Primitive::time},
    {"duration", Primitive::duration},
};

constexpr std::pair<std::string_view, Primitive> kRos2Primitives[] = {
    {"byte", Primitive::uint8},
    {"builtin_interfaces/Time", Primitive::time},
    {"builtin_interfaces/Duration", Primitive::duration},
};

constexpr std::string_view kBlanks = " \t\r";

bool is_name(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && letter(name.front()) && std::ranges::all_of(name, [&](char c) {
    return letter(c) || (c >= '0' && c <= '9') || c == '_';
  });
}

bool is_type(std::string_view type) {
  const auto slash = type.find('/');
  return slash == std::string_view::npos
             ? is_name(type)
             : is_name(type.substr(0, slash)) && is_name(type.substr(slash + 1));
}

Primitive find_primitive(std::string_view type, Dialect dialect) {
  const auto in = [&](std::span<const std::pair<std::string_view, Primitive>> types) {
    const auto found =
        std::ranges::find(types, type, &std::pair<std::string_view, Primitive>::first);
    return found == types.end() ? Primitive::message : found->second;
  };
  const Primitive common = in(kPrimitives);
  if (common != Primitive::message) {
    return common;
  }
  return dialect == Dialect::ros1 ? in(kRos1Primitives) : in(kRos2Primitives);
}

bool is_number(Primitive primitive) {
  return primitive < Primitive::text;
}

/// Reads the whole of `digits`; 0: it is not a positive number of 32 bits.
std::uint32_t positive_number(std::string_view digits) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return error == std::errc{} && end == digits.data() + digits.size() ? value : 0;
}

class Parser {
 public:
  Parser(std::string_view name, std::string_view text, Dialect dialect, std::string_view file)
      : text_(text), dialect_(dialect), file_(file.empty() ? fmt::format("{}.msg", name) : file) {
    definition_.name = name;
    definition_.text = text;
    const auto slash = name.find('/');
    if (slash == std::string_view::npos || !is_type(name)) {
      throw ConfigurationError(
          with_code(Code::unknown_message,
                    "message type '{}' has no package; write package/Type, as in "
                    "sensor_msgs/LaserScan",
                    name));
    }
    package_ = name.substr(0, slash);
  }

  Definition parse() {
    std::size_t begin = 0;
    while (begin < text_.size()) {
      const auto end = std::min(text_.find('\n', begin), text_.size());
      ++line_;
      parse_line(text_.substr(begin, end - begin));
      begin = end + 1;
    }
    return std::move(definition_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw ConfigurationError(Location{file_, line_, 0},
                             with_code(Code::message_definition, message));
  }

  std::string_view without_comment(std::string_view line) const {
    return line.substr(0, dialect_ == Dialect::ros1 ? line.find('#') : find_comment(line));
  }

  void parse_line(std::string_view original) {
    const std::string_view line = trim(without_comment(original));
    if (line.empty()) {
      return;
    }
    const auto blank = std::min(line.find_first_of(kBlanks), line.size());
    const std::string_view type = line.substr(0, blank);
    const std::string_view rest = trim(line.substr(blank));
    if (rest.empty()) {
      fail(fmt::format("'{}' has a type but no name; write 'type name'", line));
    }
    const auto name_end = std::min(rest.find_first_of(" \t="), rest.size());
    const std::string_view name = rest.substr(0, name_end);
    const std::string_view behind = trim(rest.substr(name_end));
    if (behind.starts_with('=')) {
      // In ROS 1 a constant text runs to the end of its line; a '#' in it is not a comment.
      const bool to_the_end = dialect_ == Dialect::ros1 && type == "string";
      parse_constant(
          type, name,
          to_the_end ? trim(original.substr(original.find('=') + 1)) : trim(behind.substr(1)));
    } else {
      parse_field(type, name, behind);
    }
  }

  void parse_constant(std::string_view type, std::string_view name, std::string_view value) {
    const Primitive primitive = find_primitive(type, dialect_);
    if (!is_number(primitive) && primitive != Primitive::text) {
      fail(fmt::format("a constant cannot have type '{}'; write a number type or string", type));
    }
    require_name(name);
    ConstantDefinition constant{std::string(type), std::string(name), std::string(value)};
    try {
      if (is_number(primitive)) {
        parse_number_literal(value, primitive);
      } else if (dialect_ == Dialect::ros2) {
        constant.value = parse_text_literal(value);
      }
    } catch (const std::invalid_argument& error) {
      fail(fmt::format("constant '{}' has value '{}', {}", name, value, error.what()));
    }
    definition_.constants.push_back(std::move(constant));
  }

  void parse_field(std::string_view type, std::string_view name, std::string_view otherwise) {
    constexpr std::size_t kMostFields = 20'000;
    if (definition_.fields.size() == kMostFields) {
      fail(fmt::format("the message has more than {} fields; write an array instead", kMostFields));
    }
    if (dialect_ == Dialect::ros1 && type.find("<=") != std::string_view::npos) {
      fail(fmt::format("bounded type '{}' is not part of ROS 1; write it without '<='", type));
    }
    if (dialect_ == Dialect::ros1 && !otherwise.empty()) {
      fail(
          fmt::format("'{} {}' is not a name, and ROS 1 has no default values; write a letter "
                      "followed by letters, digits and '_'",
                      name, otherwise));
    }
    require_name(name);
    FieldDefinition field;
    field.written_type = type;
    field.name = name;
    const auto bracket = type.find('[');
    // Some programs write PACKAGE/msg/Type into recordings.
    resolve_type(type, without_msg(type.substr(0, bracket)), field);
    if (bracket != std::string_view::npos) {
      parse_brackets(type.substr(bracket), field);
    }
    if (!otherwise.empty()) {
      parse_default(otherwise, field);
    }
    if (!names_.insert(field.name).second) {
      fail(fmt::format("field '{}' is there twice; give one of them another name", name));
    }
    definition_.fields.push_back(std::move(field));
  }

  void resolve_type(std::string_view written, std::string_view base, FieldDefinition& field) const {
    constexpr std::string_view kBoundedText = "string<=";
    if (base.starts_with(kBoundedText)) {
      field.longest_text = positive_number(base.substr(kBoundedText.size()));
      if (field.longest_text == 0) {
        fail(fmt::format("'{}' bounds no text; write string<=number", base));
      }
      base = base.substr(0, kBoundedText.find('<'));
    }
    if (!is_type(base)) {
      fail(fmt::format("'{}' is not a type; write a built-in type, Type or package/Type", written));
    }
    if (base == "wstring") {
      fail("texts of type 'wstring' are not read here, and hardly used; write string");
    }
    if (dialect_ == Dialect::ros2 && (base == "time" || base == "duration")) {
      fail(fmt::format("'{}' is not part of ROS 2; write builtin_interfaces/{}", base,
                       base == "time" ? "Time" : "Duration"));
    }
    field.primitive = find_primitive(base, dialect_);
    field.type = base;
    if (field.primitive == Primitive::message && base.find('/') == std::string_view::npos) {
      const bool is_header = base == "Header" && dialect_ == Dialect::ros1;
      field.type = is_header ? "std_msgs/Header" : fmt::format("{}/{}", package_, base);
    }
    if (package_ == "builtin_interfaces" && dialect_ == Dialect::ros2) {
      field.primitive = find_primitive(field.type, dialect_);
    }
  }

  void parse_brackets(std::string_view brackets, FieldDefinition& field) const {
    const bool closed = brackets.size() > 1 && brackets.back() == ']';
    std::string_view inside = closed ? brackets.substr(1, brackets.size() - 2) : std::string_view{};
    field.array = ArrayKind::variable;
    if (closed && inside.empty()) {
      return;
    }
    const bool bounded = inside.starts_with("<=");
    field.array = bounded ? ArrayKind::variable : ArrayKind::fixed;
    field.count = positive_number(inside.substr(bounded ? 2 : 0));
    const bool none = dialect_ == Dialect::ros1 && inside == "0";
    if (field.count == 0 && !none) {
      fail(
          fmt::format("'{}' is not an array length; write {}", brackets,
                      dialect_ == Dialect::ros1 ? "[] or [number]" : "[], [number] or [<=number]"));
    }
  }

  void parse_default(std::string_view text, FieldDefinition& field) const {
    if (!is_number(field.primitive) && field.primitive != Primitive::text) {
      fail(fmt::format("field '{}' is a {}, which has no default value; take '{}' out", field.name,
                       field.type, text));
    }
    try {
      std::vector<std::string_view> elements = {text};
      if (field.array != ArrayKind::none) {
        elements = split_list_literal(text);
        check_count(elements.size(), field);
      }
      for (const std::string_view element : elements) {
        if (field.primitive != Primitive::text) {
          field.otherwise.numbers.push_back(parse_number_literal(element, field.primitive));
          continue;
        }
        field.otherwise.texts.push_back(parse_text_literal(element));
        if (field.longest_text != 0 && field.otherwise.texts.back().size() > field.longest_text) {
          throw std::invalid_argument(
              fmt::format("which is longer than {} bytes", field.longest_text));
        }
      }
    } catch (const std::invalid_argument& error) {
      fail(fmt::format("field '{}' has default value '{}', {}", field.name, text, error.what()));
    }
  }

  static void check_count(std::size_t count, const FieldDefinition& field) {
    const bool fixed = field.array == ArrayKind::fixed;
    if (fixed ? count != field.count : field.count != 0 && count > field.count) {
      throw std::invalid_argument(fmt::format("which has {} elements; write {}{}", count,
                                              fixed ? "" : "at most ", field.count));
    }
  }

  void require_name(std::string_view name) const {
    if (!is_name(name)) {
      fail(fmt::format("'{}' is not a name; write a letter followed by letters, digits and '_'",
                       name));
    }
  }

  std::string_view text_;
  Dialect dialect_;
  std::string file_;
  std::string package_;
  Definition definition_;
  std::set<std::string> names_;
  int line_ = 0;
};

}  // namespace

Definition parse_definition(std::string_view name, std::string_view text, Dialect dialect,
                            std::string_view file) {
  return Parser(name, text, dialect, file).parse();
}

}  // namespace spikeloop::messages
