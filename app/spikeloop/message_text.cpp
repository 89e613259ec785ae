#include "message_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::app {
namespace {

using messages::ArrayKind;
using messages::Catalog;
using messages::Dialect;
using messages::FieldLayout;
using messages::Primitive;
using messages::TypeLayout;

constexpr const char* kPrimitives[] = {"bool",    "int8",   "uint8",   "int16",  "uint16",
                                       "int32",   "uint32", "int64",   "uint64", "float32",
                                       "float64", "string", "seconds", "seconds"};

constexpr const char* kHints =
    "Of an array: ranges[7], ranges[0:100], position[name=left_wheel]. Of a time: .sec, "
    ".nanosec.\n";

/// A path that ends at a value, and what it is.
struct PathLine {
  std::string path;
  std::string type;
  bool operator==(const PathLine&) const = default;
};

std::string type_text(const FieldLayout& field) {
  const std::string element = kPrimitives[static_cast<std::size_t>(field.primitive)];
  if (field.array == ArrayKind::none) {
    return element;
  }
  const char* const most = field.array == ArrayKind::variable ? "<=" : "";
  return field.count == 0 ? element + "[]" : fmt::format("{}[{}{}]", element, most, field.count);
}

void add_paths(const TypeLayout& type, const std::string& prefix, std::vector<PathLine>& lines) {
  for (const FieldLayout& field : type.fields) {
    const std::string path = prefix + field.name;
    if (field.primitive == Primitive::message) {
      add_paths(*field.message, path + (field.array == ArrayKind::none ? "." : "[0]."), lines);
    } else {
      lines.push_back({path, type_text(field)});
    }
  }
}

/// A type in one ROS.
struct Described {
  std::string name;
  std::string sum;
  std::string definition;
  std::vector<PathLine> paths;
};

Described describe(Dialect dialect, const std::string& type) {
  const Catalog& catalog = Catalog::for_type(dialect, type);
  Described result;
  result.name = catalog.full_name(type);
  result.sum =
      dialect == Dialect::ros1 ? "md5 " + catalog.md5(result.name) : catalog.type_hash(result.name);
  result.definition = catalog.find(result.name).text;
  add_paths(*catalog.layout(result.name), "", result.paths);
  return result;
}

std::string indented(const std::string& text) {
  std::string result;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = std::min(text.find('\n', begin), text.size());
    result += "  " + text.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return result.empty() ? "  (no fields)\n" : result;
}

std::string path_lines(const std::vector<PathLine>& lines) {
  std::size_t width = 0;
  for (const PathLine& line : lines) {
    width = std::max(width, line.path.size());
  }
  std::string text;
  for (const PathLine& line : lines) {
    text += fmt::format("  {:<{}}  {}\n", line.path, width, line.type);
  }
  return text;
}

/// What both have, once; else one behind the other.
template <typename Part>
std::string parts(const char* title, const std::optional<Described>& ros1,
                  const std::optional<Described>& ros2, Part part) {
  if (!ros1 || !ros2 || part(*ros1) == part(*ros2)) {
    return fmt::format("\n{}:\n{}", title, part(ros1 ? *ros1 : *ros2));
  }
  return fmt::format("\n{0} of ROS 1:\n{1}\n{0} of ROS 2:\n{2}", title, part(*ros1), part(*ros2));
}

}  // namespace

std::string message_list() {
  const Catalog& ros1 = Catalog::builtin(Dialect::ros1);
  const Catalog& ros2 = Catalog::builtin(Dialect::ros2);
  std::vector<std::string> names = ros1.names();
  for (const std::string& name : ros2.names()) {
    if (!ros1.contains(name)) {
      names.push_back(name);
    }
  }
  std::ranges::sort(names);
  std::string text;
  for (const std::string& name : names) {
    text += name +
            (!ros2.contains(name)   ? "  (ROS 1)"
             : !ros1.contains(name) ? "  (ROS 2)"
                                    : "") +
            "\n";
  }
  return text + "spikeloop describe PACKAGE/TYPE prints details.\n";
}

bool is_message_type(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".msg");
}

std::string message_text(const std::string& type) {
  std::optional<Described> ros1;
  std::optional<Described> ros2;
  std::optional<ConfigurationError> wrong;
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    try {
      (dialect == Dialect::ros1 ? ros1 : ros2) = describe(dialect, type);
    } catch (const ConfigurationError& error) {
      wrong = error;
    }
  }
  if (!ros1 && !ros2) {
    throw *wrong;
  }
  std::string text = (ros1 ? ros1 : ros2)->name + "\n";
  text += "  ROS 1: " + (ros1 ? ros1->sum : "none") + "\n";
  text += "  ROS 2: " + (ros2 ? ros2->sum : "none") + "\n";
  text +=
      parts("Definition", ros1, ros2, [](const Described& of) { return indented(of.definition); });
  text +=
      parts("Field paths", ros1, ros2, [](const Described& of) { return path_lines(of.paths); });
  return text + kHints;
}

}  // namespace spikeloop::app
