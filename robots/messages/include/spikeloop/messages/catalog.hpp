// A set of message definitions that know each other.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/definition.hpp"

namespace spikeloop::messages {

struct TypeLayout;

/// A field with its type resolved.
struct FieldLayout {
  std::string name;
  Primitive primitive = Primitive::message;
  std::shared_ptr<const TypeLayout> message;  ///< of Primitive::message, else empty
  ArrayKind array = ArrayKind::none;
  std::uint32_t count = 0;                   ///< of a fixed array
  std::optional<std::size_t> element_bytes;  ///< packed size of one element, when it is constant
  std::size_t element_least = 0;             ///< packed size of the smallest element
};

/// What stands one after the other in a message, whatever encodes it.
struct TypeLayout {
  std::string name;
  std::vector<FieldLayout> fields;
  std::optional<std::size_t> bytes;  ///< packed size of all fields, when it is constant
  std::size_t least = 0;             ///< packed size of the smallest message
};

class Catalog {
 public:
  /// The definitions that Spikeloop brings along: those of ROS 1.
  static const Catalog& builtin();

  /// @throws ConfigurationError as parse_definition. A definition of that name is replaced.
  void add(std::string_view name, std::string_view text);
  /// Adds a definition together with those it needs, in the form in which a ROS 1 publisher sends
  /// it: texts divided by a line of '=' and "MSG: package/Type".
  void add_with_dependencies(std::string_view name, std::string_view full_text);

  bool contains(std::string_view name) const;
  std::vector<std::string> names() const;  ///< sorted

  /// @throws ConfigurationError with "did you mean".
  const Definition& find(std::string_view name) const;
  /// Spells out a type: "LaserScan" and "sensor_msgs/LaserScan" are the same.
  /// @throws ConfigurationError: unknown, or the same name in two packages.
  std::string full_name(std::string_view name) const;
  /// The sum by which ROS 1 tells versions apart. @throws ConfigurationError when a part is
  /// missing.
  std::string md5(std::string_view name) const;
  /// The `message_definition` of a ROS 1 connection: the text and those of all parts, each once.
  std::string full_text(std::string_view name) const;
  /// @throws ConfigurationError when a part is missing or a message contains itself.
  std::shared_ptr<const TypeLayout> layout(std::string_view name) const;

 private:
  std::shared_ptr<const TypeLayout> layout(std::string_view name,
                                           std::vector<std::string>& within) const;
  const Definition& part(const Definition& whole, const FieldDefinition& field) const;

  std::map<std::string, Definition, std::less<>> definitions_;
};

}  // namespace spikeloop::messages
