// Messages as columns: all values of one field of many messages, for arrays of NumPy.
//
// The column of ranges of a LaserScan has the ranges of all messages one after the other, and as
// counts[0] the number of ranges in each message. transforms.transform.translation.x of a TFMessage
// has one number per transform, and as counts[0] the number of transforms in each message. A field
// below two arrays has two lists of counts: counts[1] has an entry per element of the outer array.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::messages {

struct Column {
  std::string path;                          ///< "header.stamp"
  Primitive primitive = Primitive::float64;  ///< not Primitive::message
  /// Values in little-endian order; times and durations are float64 in s. Empty for texts.
  std::vector<std::byte> numbers{};
  std::vector<std::string> texts{};
  std::vector<std::vector<std::uint32_t>> counts{};  ///< per array on the path, outermost first
};

class ColumnReader {
 public:
  /// @param paths fields to read, with all fields below them; empty: all fields
  /// @throws ConfigurationError if there is no such field; suggests a similar name
  explicit ColumnReader(std::shared_ptr<const TypeLayout> type,
                        const std::vector<std::string>& paths = {});
  ~ColumnReader();
  ColumnReader(const ColumnReader&) = delete;
  ColumnReader& operator=(const ColumnReader&) = delete;

  /// Appends the values of one message. @throws TransportError: the message is damaged; the columns
  /// are incomplete then
  void read(std::span<const std::byte> message);
  /// In the order of the definition.
  std::vector<Column> take_columns();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::messages
