// Reads a JSON weight table number by number, without a tree of JSON values in memory.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/weights.hpp"

namespace spikeloop {

/// The SAX handler of nlohmann-json for both forms of a table. Its functions throw
/// ConfigurationError for JSON that is not a weight table; `parse_error` keeps JSON's own errors.
class WeightTableReader {
 public:
  using Json = nlohmann::json;

  struct JsonError {
    std::size_t offset = 0;  ///< of the byte
    std::string reason;      ///< empty: none
  };
  struct Entry {
    std::uint32_t row = 0;
    std::uint32_t column = 0;
    double weight = 0;
  };

  WeightTableReader(std::string_view text, std::string file)
      : text_(text), file_(std::move(file)) {}

  bool null() { return wrong("null"); }
  bool boolean(bool value) { return wrong(value ? "true" : "false"); }
  bool number_integer(std::int64_t value);
  bool number_unsigned(std::uint64_t value);
  bool number_float(double value, const std::string& written);
  bool string(const std::string& value);
  bool binary(const Json::binary_t&) { return wrong("binary data"); }
  bool start_object(std::size_t);
  bool key(const std::string& name);
  bool end_object();
  bool start_array(std::size_t);
  bool end_array();
  bool parse_error(std::size_t position, const std::string& token, const Json::exception& error);

  /// True when a whole table has been read, whatever follows it.
  bool finished() const { return place_ == Place::after; }
  const JsonError& error() const { return error_; }

  bool is_sparse() const { return sparse_; }
  /// Dense: the rows one after another, and where each begins (rows + 1 entries).
  std::vector<double>& values() { return values_; }
  const std::vector<std::uint64_t>& row_begin() const { return row_begin_; }
  /// Sparse: checked and sorted.
  WeightTable sparse_table();

 private:
  enum class Place { before, rows, row, object, entries, entry, after };

  std::string at() const;
  bool wrong(const std::string& what);
  bool number(double value, bool whole, const std::string& written);
  bool object_number(double value, bool whole, const std::string& written);
  bool entry_number(double value, bool whole, const std::string& written);
  void finish_entry();
  [[noreturn]] void fail(const std::string& message) const;

  std::string_view text_;
  std::string file_;
  Place place_ = Place::before;
  JsonError error_;
  bool sparse_ = false;
  std::vector<double> values_;
  std::vector<std::uint64_t> row_begin_{0};

  std::string key_;
  std::set<std::string> keys_;
  std::uint32_t rows_ = 0;
  std::uint32_t columns_ = 0;
  std::vector<double> items_;   ///< of the entry being read
  std::vector<Entry> entries_;  ///< indices as written, checked at the end: "rows" may follow
};

}  // namespace spikeloop
