// Field paths: which numbers of a message are meant. "ranges", "ranges[0:100]", "ranges[7]",
// "pose.pose.position.x", "layout.dim[0].size", "header.stamp" (seconds), "header.stamp.secs" (or
// "sec"; "nsecs" or "nanosec"), "position[name=left_wheel]", "transforms[child_frame_id=base]".
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::messages {

/// The most elements of an array that a path reaches and takes, as many as a port can have
/// channels: a message that is written is as long as the element that a path names.
constexpr std::size_t kMostElements = std::size_t{1} << 24;

/// The element that a text names: [name=left_wheel]. It is the first one whose field `name` is this
/// text; when elements have no such text, the one at the place of this text in the array `name`
/// beside theirs, as in sensor_msgs/JointState.
struct Selector {
  bool within = false;  ///< the text is in the elements
  std::size_t key = 0;  ///< index of the field with the texts, in its message
  std::string text;
};

/// One name of a path with the elements it takes: [first, last).
struct PathStep {
  static constexpr std::size_t kEnd = std::numeric_limits<std::size_t>::max();
  std::size_t field = 0;  ///< index within its message
  std::size_t first = 0;  ///< with a selector the message says which one: first and last are 0, 1
  std::size_t last = kEnd;
  std::optional<Selector> selector{};
  std::size_t least_length = 0;  ///< of the array, in a message that is written
};

/// A path checked against a type.
struct FieldPath {
  enum class TimePart : std::uint8_t { whole, secs, nsecs };

  std::string text;
  std::shared_ptr<const TypeLayout> type;
  std::vector<PathStep> steps;
  TimePart time_part = TimePart::whole;

  /// That a step names. @param level the step's number
  const FieldLayout& field(std::size_t level) const;
  const FieldLayout& target() const { return field(steps.size() - 1); }
  bool is_text() const { return target().primitive == Primitive::text; }
  /// How many values it names; nothing when that is the message's to say.
  std::optional<std::size_t> width() const;
};

/// @throws ConfigurationError that names type, path and remedy: no such field (did you mean), an
/// index where there is no array, beyond its end or beyond kMostElements, a selector without texts
/// to select by, a path that ends at a message.
FieldPath compile_path(const Catalog& catalog, std::string_view type, std::string_view path);

/// Takes the numbers of one path out of messages.
class FieldReader {
 public:
  /// @throws ConfigurationError as compile_path, and when the path ends at a text.
  FieldReader(const Catalog& catalog, std::string_view type, std::string_view path);

  /// Appends the path's numbers; elements that an array does not have are left out, and so is one
  /// whose text is not there. Returns how many came. 64-bit whole numbers beyond 2^53 lose their
  /// last digits.
  /// @param message bytes in the catalog's dialect; nothing about them is taken for granted.
  /// @throws TransportError when they end too early, or are encoded otherwise.
  std::size_t read(std::span<const std::byte> message, std::vector<double>& values) const;

  const FieldPath& path() const { return path_; }

 private:
  FieldPath path_;
};

/// Reads the texts of a path from messages: Image.encoding, header.frame_id, PointCloud2's
/// fields.name (one text per element).
class TextField {
 public:
  /// @throws ConfigurationError as compile_path, and if the path ends at a number.
  TextField(const Catalog& catalog, std::string_view type, std::string_view path);

  /// Appends the path's texts, which are valid as long as the message's bytes, and returns their
  /// number. @throws TransportError as FieldReader::read.
  std::size_t read(std::span<const std::byte> message, std::vector<std::string_view>& texts) const;

  const FieldPath& path() const { return path_; }

 private:
  FieldPath path_;
};

}  // namespace spikeloop::messages
