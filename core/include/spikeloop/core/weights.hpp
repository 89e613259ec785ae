// A linear map between channels: rows are outputs, columns are inputs.
#pragma once

#include <cstdint>
#include <vector>

namespace spikeloop {

/// The shapes a weight table comes in. A table that was written without a size (uniform,
/// one-to-one, blocks) takes its size from the ports: see `resized`.
struct WeightTable {
  enum class Kind {
    dense,       ///< `values` has rows * columns numbers, row by row
    sparse,      ///< compressed rows: `row_start`, `column`, `values`
    uniform,     ///< every weight is `values[0]`; without a value, 1 / columns (a mean)
    one_to_one,  ///< row i reads column i with weight `values[0]` (1 when empty)
    /// row i is `values[0]` (1 when empty) times the mean of the i-th of as many equal blocks of
    /// neighbouring columns as there are rows; becomes sparse when it is resized
    blocks
  };

  Kind kind = Kind::dense;
  std::uint32_t rows = 0;     ///< 0: as wide as the output port
  std::uint32_t columns = 0;  ///< 0: as wide as the input port
  std::vector<double> values;
  std::vector<std::uint64_t> row_start;  ///< sparse: rows + 1 entries
  std::vector<std::uint32_t> column;     ///< sparse: ascending within a row
  double fitted_tau_s = 0;  ///< time constant of the filtered spikes that it was fitted to; 0: none

  static WeightTable dense(std::uint32_t rows, std::uint32_t columns, std::vector<double> values);
  static WeightTable uniform();
  static WeightTable uniform(double weight);
  static WeightTable one_to_one(double weight = 1.0);
  static WeightTable blocks(double weight = 1.0);
  /// No numbers: stands for a node's own rule to space evenly what it prefers (population_vector).
  static WeightTable even();
  bool is_even() const;

  /// The table for ports of these widths.
  /// @throws ConfigurationError naming both sizes when they disagree, or when one-to-one meets
  /// ports of different widths, blocks that are not equal, or when there are no numbers.
  WeightTable resized(std::uint32_t output_width, std::uint32_t input_width) const;

  /// The same map as compressed rows; needs a size. Zeros of a dense table are kept out.
  WeightTable compressed() const;

  /// Weight from input `column_index` to output `row_index`; needs a size.
  double at(std::uint32_t row_index, std::uint32_t column_index) const;
};

}  // namespace spikeloop
