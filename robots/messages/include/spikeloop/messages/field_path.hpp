// Field paths: which numbers of a message are meant. "ranges", "ranges[0:100]", "ranges[7]",
// "pose.pose.position.x", "layout.dim[0].size", "header.stamp" (seconds), "header.stamp.secs".
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

/// One name of a path with the elements it takes: [first, last).
struct PathStep {
  static constexpr std::size_t kEnd = std::numeric_limits<std::size_t>::max();
  std::size_t field = 0;  ///< index within its message
  std::size_t first = 0;
  std::size_t last = kEnd;
};

/// A path checked against a type.
struct FieldPath {
  enum class TimePart : std::uint8_t { whole, secs, nsecs };

  std::string text;
  std::shared_ptr<const TypeLayout> type;
  std::vector<PathStep> steps;
  TimePart time_part = TimePart::whole;

  const FieldLayout& target() const;
  bool is_text() const { return target().primitive == Primitive::text; }
  /// How many values it names; nothing when that is the message's to say.
  std::optional<std::size_t> width() const;
};

/// @throws ConfigurationError that names type, path and remedy: no such field (did you mean), an
/// index where there is no array or beyond its end, a path that ends at a message.
FieldPath compile_path(const Catalog& catalog, std::string_view type, std::string_view path);

/// Takes the numbers of one path out of messages.
class FieldReader {
 public:
  /// @throws ConfigurationError as compile_path, and when the path ends at a text.
  FieldReader(const Catalog& catalog, std::string_view type, std::string_view path);

  /// Appends the path's numbers; elements that an array does not have are left out. Returns how
  /// many came. 64-bit whole numbers beyond 2^53 lose their last digits.
  /// @param message bytes in ROS 1's serialization; nothing about them is taken for granted.
  /// @throws TransportError when they end too early.
  std::size_t read(std::span<const std::byte> message, std::vector<double>& values) const;

  const FieldPath& path() const { return path_; }

 private:
  FieldPath path_;
};

}  // namespace spikeloop::messages
