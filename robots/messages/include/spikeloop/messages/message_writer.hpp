// Bytes of a message from the values of some of its fields.
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
  std::span<const double> numbers{};
  std::string_view text{};
  /// In place of numbers: all elements of a variable array of uint8, as a picture.
  std::span<const std::byte> bytes{};
};

class MessageWriter {
 public:
  /// @param paths the fields that `write` sets. A variable array is as long as its values, or as
  /// the elements that are named need. An element that is chosen by a text, as in
  /// position[name=left_wheel], gets a place in the order of the paths, and the message gets the
  /// text: name[0] is left_wheel.
  /// @throws ConfigurationError as compile_path; when two paths name the same field; when a path
  /// goes through a variable array without naming its elements; when more elements are named than
  /// an array can have.
  MessageWriter(const Catalog& catalog, std::string_view type,
                const std::vector<std::string>& paths);

  /// Replaces `message` by the bytes in the catalog's dialect. `values` runs parallel to the paths.
  /// Whole-number fields take the nearest value they can hold, NaN as 0. Fields that no path names
  /// have their default value, or are zero or empty. Elements of parallel arrays (JointState,
  /// JointTrajectory, Float64MultiArray) that no path names are NaN: not commanded.
  /// @throws ConfigurationError when a path gets another number of values than it names, or more
  /// values or a longer text than the field can hold.
  /// @throws std::logic_error when bytes are given for another field than a whole variable array
  /// of uint8.
  void write(std::span<const FieldValue> values, std::vector<std::byte>& message) const;

  const TypeLayout& type() const { return *type_; }

 private:
  void add(FieldPath path);
  void check_length(const FieldPath& path) const;
  void check_text(const FieldPath& path, std::string_view text) const;
  void check_numbers(const FieldPath& path, const FieldValue& value) const;

  std::shared_ptr<const TypeLayout> type_;
  std::vector<FieldPath> paths_;
  std::vector<std::string> texts_;  ///< of the last paths, which the user did not write
};

}  // namespace spikeloop::messages
