#include "spikeloop/messages/definition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <utility>

#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

constexpr std::pair<std::string_view, Primitive> kPrimitives[] = {
    {"bool", Primitive::boolean},    {"int8", Primitive::int8},
    {"byte", Primitive::int8},       {"uint8", Primitive::uint8},
    {"char", Primitive::uint8},      {"int16", Primitive::int16},
    {"uint16", Primitive::uint16},   {"int32", Primitive::int32},
    {"uint32", Primitive::uint32},   {"int64", Primitive::int64},
    {"uint64", Primitive::uint64},   {"float32", Primitive::float32},
    {"float64", Primitive::float64}, {"string", Primitive::text},
    {"time", Primitive::time},       {"duration", Primitive::duration},
};

constexpr std::string_view kBlanks = " \t\r";

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

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

class Parser {
 public:
  Parser(std::string_view name, std::string_view text) : text_(text) {
    definition_.name = name;
    definition_.text = text;
    const auto slash = name.find('/');
    if (slash == std::string_view::npos || !is_type(name)) {
      throw ConfigurationError(
          fmt::format("message type '{}' has no package; write package/Type, as in "
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
    throw ConfigurationError(Location{definition_.name + ".msg", line_, 0}, message);
  }

  void parse_line(std::string_view original) {
    const std::string_view line = trim(original.substr(0, original.find('#')));
    if (line.empty()) {
      return;
    }
    const auto blank = std::min(line.find_first_of(kBlanks), line.size());
    const std::string_view type = line.substr(0, blank);
    const std::string_view rest = trim(line.substr(blank));
    if (rest.empty()) {
      fail(fmt::format("'{}' has a type but no name; write 'type name'", line));
    }
    if (rest.find('=') != std::string_view::npos &&
        type.find_first_of("<=") == std::string_view::npos) {
      parse_constant(type, original);
    } else {
      parse_field(type, rest);
    }
  }

  void parse_constant(std::string_view type, std::string_view original) {
    const bool is_text = type == "string";
    // A constant text runs to the end of its line; a '#' in it is no comment.
    const std::string_view line = is_text ? original : original.substr(0, original.find('#'));
    const auto equals = line.find('=');
    const std::string_view name =
        trim(line.substr(line.find(type) + type.size(), equals - line.find(type) - type.size()));
    const std::string_view value = trim(line.substr(equals + 1));
    const Primitive primitive = find_primitive(type);
    if (primitive >= Primitive::text && !is_text) {
      fail(fmt::format("a constant cannot have type '{}'; write a number type or string", type));
    }
    require_name(name);
    if (!is_text) {
      double number = 0;
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
      const bool truth = primitive == Primitive::boolean && (value == "True" || value == "False");
      if (!truth && (error != std::errc{} || end != value.data() + value.size())) {
        fail(fmt::format("constant '{}' has value '{}', which is no number", name, value));
      }
    }
    definition_.constants.push_back({std::string(type), std::string(name), std::string(value)});
  }

  void parse_field(std::string_view type, std::string_view name) {
    FieldDefinition field;
    field.written_type = type;
    field.name = name;
    if (type.find("<=") != std::string_view::npos) {
      fail(fmt::format("bounded type '{}' is not part of ROS 1; write it without '<='", type));
    }
    require_name(name);
    const auto bracket = type.find('[');
    const std::string_view base = type.substr(0, bracket);
    if (!is_type(base)) {
      fail(fmt::format("'{}' is no type; write a built-in type, Type or package/Type", type));
    }
    if (bracket != std::string_view::npos) {
      parse_brackets(type.substr(bracket), field);
    }
    field.primitive = find_primitive(base);
    field.type = base;
    if (field.primitive == Primitive::message && base.find('/') == std::string_view::npos) {
      field.type = base == "Header" ? "std_msgs/Header" : fmt::format("{}/{}", package_, base);
    }
    for (const FieldDefinition& other : definition_.fields) {
      if (other.name == field.name) {
        fail(fmt::format("field '{}' is there twice; give one of them another name", name));
      }
    }
    definition_.fields.push_back(std::move(field));
  }

  void parse_brackets(std::string_view brackets, FieldDefinition& field) const {
    if (brackets == "[]") {
      field.array = ArrayKind::variable;
      return;
    }
    const std::string_view digits =
        brackets.size() > 2 ? brackets.substr(1, brackets.size() - 2) : std::string_view{};
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), field.count);
    if (brackets.back() != ']' || error != std::errc{} || end != digits.data() + digits.size()) {
      fail(fmt::format("'{}' is no array length; write [] or [number]", brackets));
    }
    field.array = ArrayKind::fixed;
  }

  void require_name(std::string_view name) const {
    if (!is_name(name)) {
      fail(
          fmt::format("'{}' is no name; write a letter followed by letters, digits and '_'", name));
    }
  }

  static Primitive find_primitive(std::string_view type) {
    for (const auto& [name, primitive] : kPrimitives) {
      if (name == type) {
        return primitive;
      }
    }
    return Primitive::message;
  }

  std::string_view text_;
  std::string package_;
  Definition definition_;
  int line_ = 0;
};

}  // namespace

Definition parse_definition(std::string_view name, std::string_view text) {
  return Parser(name, text).parse();
}

}  // namespace spikeloop::messages
