// Weight tables in JSON: rows of numbers, or the entries of a sparse table.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "spikeloop/core/weights.hpp"

namespace spikeloop {

/// The rows one after another, and where each begins; then where the last one ends.
struct WeightRows {
  std::vector<double> values;
  std::vector<std::uint64_t> begin{0};
  double fitted_tau_s = 0;  ///< as WeightTable's
};

/// @param whole  false: text after the table is left out with a warning, as the older programs do
/// @throws ConfigurationError for what is not a weight table
std::variant<WeightRows, WeightTable> read_weight_json(std::string_view text,
                                                       const std::string& file, bool whole);

}  // namespace spikeloop
