// Bytes of a message from the values of some of its fields; the others are zero or empty.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::messages {

/// What a path is to be: numbers, or a text for a field of type string.
struct FieldValue {
  std::span<const double> numbers;
  std::string_view text;
};

class MessageWriter {
 public:
  /// @param paths the fields that `write` sets. A variable array is as long as its values, or as
  /// the elements that are named need.
  /// @throws ConfigurationError as compile_path; when two paths name the same field; when a path
  /// goes through a variable array without naming its elements.
  MessageWriter(const Catalog& catalog, std::string_view type,
                const std::vector<std::string>& paths);

  /// Replaces `message` by the bytes in ROS 1's serialization. `values` runs parallel to the paths.
  /// Whole-number fields take the nearest value they can hold, NaN as 0.
  /// @throws ConfigurationError when a path gets another number of values than it names.
  void write(std::span<const FieldValue> values, std::vector<std::byte>& message) const;

  const TypeLayout& type() const { return *type_; }

 private:
  void check(std::span<const FieldValue> values) const;

  std::shared_ptr<const TypeLayout> type_;
  std::vector<FieldPath> paths_;
};

}  // namespace spikeloop::messages
