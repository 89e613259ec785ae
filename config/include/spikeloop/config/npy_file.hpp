// NumPy's .npy files: tables of weights come from them, and fitted weights go into them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop {

/// Whether bytes begin as every .npy file does.
bool is_npy(std::string_view bytes);

/// An array of 2 dimensions, or of 1, which is a single row. Format versions 1.0, 2.0 and 3.0; C
/// and Fortran order; float64, float32 and whole numbers of 1 to 8 bytes, whatever their byte
/// order. Whole numbers beyond 2^53 lose their last digits.
class NpyArray {
 public:
  /// Reads what the header says; `bytes` must outlive the object, `file` only names it in messages.
  /// @throws ConfigurationError with file, what is wrong and what to write: no .npy file, cut off,
  /// another version, no numbers, another number of dimensions.
  NpyArray(std::string_view bytes, std::string file);

  std::uint64_t rows() const { return rows_; }
  std::uint64_t columns() const { return columns_; }
  /// Bytes behind the array.
  std::uint64_t surplus() const { return surplus_; }
  /// The numbers row by row. @throws ConfigurationError with row and column (from 0) of a number
  /// that is not finite.
  std::vector<double> values() const;

 private:
  std::string file_;
  std::string_view data_;
  std::string type_;
  std::uint64_t rows_ = 0;
  std::uint64_t columns_ = 0;
  std::uint64_t surplus_ = 0;
  bool by_columns_ = false;
};

/// Writes `values`, row by row, as float64 that numpy.load reads as an array [rows, columns].
/// @throws FileError when it cannot be written; std::logic_error when their number is not
/// rows * columns.
void write_npy(const std::filesystem::path& path, std::uint64_t rows, std::uint64_t columns,
               std::span<const double> values);

}  // namespace spikeloop
