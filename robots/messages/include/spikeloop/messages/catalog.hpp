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

/// Bytes; roscpp refuses longer messages.
constexpr std::size_t kLargestMessage = 1'000'000'000;

/// Converts names of types as ROS 2's tools write them, "sensor_msgs/msg/LaserScan" and
/// "sensor_msgs::msg::LaserScan", to "sensor_msgs/LaserScan".
std::string without_msg(std::string_view name);

struct TypeLayout;

/// A field with its type resolved. Sizes are those of the catalog's dialect, without what aligns
/// them.
struct FieldLayout {
  std::string name;
  Primitive primitive = Primitive::message;
  std::shared_ptr<const TypeLayout> message;  ///< of Primitive::message, else empty
  ArrayKind array = ArrayKind::none;
  std::uint32_t count = 0;         ///< of a fixed array; the most of a variable one, 0: any number
  std::uint32_t longest_text = 0;  ///< bytes; 0: any number
  DefaultValue otherwise{};
  std::optional<std::size_t> element_bytes;  ///< of one element, when elements follow without gaps
  std::size_t alignment = 1;                 ///< of such elements
  std::size_t element_least = 0;             ///< bytes of the smallest element
};

/// What stands one after the other in a message, whatever encodes it.
struct TypeLayout {
  std::string name;
  Dialect dialect = Dialect::ros1;
  std::vector<FieldLayout> fields;
  std::optional<std::size_t> bytes;  ///< of all fields, when constant and without gaps
  std::size_t alignment = 1;         ///< of all fields, when `bytes` says so
  std::size_t least = 0;             ///< bytes of the smallest message
};

class Catalog {
 public:
  /// An empty one.
  explicit Catalog(Dialect dialect) : dialect_(dialect) {}
  /// The definitions that Spikeloop brings along.
  static const Catalog& builtin(Dialect dialect);
  /// The definitions to use with a type as users name it: the builtin ones, and when it is the path
  /// of a `.msg` file, or a name from a file that was read before, that one's with what it needs.
  /// Each file is read once a process, and the result lives as long.
  /// @throws ConfigurationError as add_file.
  static const Catalog& for_type(Dialect dialect, std::string_view type);

  Dialect dialect() const { return dialect_; }

  /// @throws ConfigurationError as parse_definition. A definition of that name is replaced.
  void add(std::string_view name, std::string_view text);
  /// Adds a definition together with those it needs, in the form in which a ROS 1 publisher sends
  /// it: texts divided by a line of '=' and "MSG: package/Type".
  void add_with_dependencies(std::string_view name, std::string_view full_text);

  /// Adds the definition in PACKAGE/msg/TYPE.msg and returns its name, PACKAGE/TYPE. Parts of the
  /// same package, and of packages that the catalog does not have, are read from beside it:
  /// PACKAGE/msg/PART.msg, and OTHER/msg/PART.msg where the folder PACKAGE is.
  /// @throws ConfigurationError that names the file: it cannot be read, is in no folder `msg`, has
  /// a wrong line, or needs a part that is nowhere.
  std::string add_file(const std::string& path);

  bool contains(std::string_view name) const;
  std::vector<std::string> names() const;  ///< sorted

  /// @throws ConfigurationError with "did you mean".
  const Definition& find(std::string_view name) const;
  /// Spells out a type: "LaserScan", "sensor_msgs/LaserScan" and "sensor_msgs/msg/LaserScan" are
  /// the same; a file that was added stands for what it defines.
  /// @throws ConfigurationError: unknown, or the same name in two packages.
  std::string full_name(std::string_view name) const;
  /// The sum by which ROS 1 tells versions apart. @throws ConfigurationError when a part is
  /// missing.
  std::string md5(std::string_view name) const;
  /// The sum by which ROS 2 (Iron and later) does, "RIHS01_" and 64 hexadecimal digits (REP 2016).
  /// @throws ConfigurationError when a part is missing; std::logic_error in ROS 1, which has none.
  std::string type_hash(std::string_view name) const;
  /// The `message_definition` of a ROS 1 connection: the text and those of all parts, each once.
  std::string full_text(std::string_view name) const;
  /// @throws ConfigurationError when a part is missing, a message contains itself, or it has more
  /// than 20,000 fields with those of its parts, or 64 parts inside of each other.
  std::shared_ptr<const TypeLayout> layout(std::string_view name) const;

 private:
  struct Walk;  ///< through the types of a message
  std::shared_ptr<const TypeLayout> layout(std::string_view name, Walk& walk) const;
  const Definition& part(const Definition& whole, const FieldDefinition& field) const;
  void add_parts_beside(const Definition& whole, const std::string& path);

  Dialect dialect_;
  std::map<std::string, Definition, std::less<>> definitions_;
  std::map<std::string, std::string, std::less<>> files_;  ///< path to the type that it defines
};

}  // namespace spikeloop::messages
