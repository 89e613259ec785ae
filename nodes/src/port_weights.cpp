#include "port_weights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include "spikeloop/core/code.hpp"

namespace spikeloop {

namespace {

void check_dense(const WeightTable& table) {
  const std::size_t needed = std::size_t{table.rows} * table.columns;
  if (table.values.size() != needed) {
    throw ConfigurationError(with_code(
        Code::weights_differ,
        "the weights hold {} numbers, but {} rows of {} columns need {}; write one row an output",
        table.values.size(), table.rows, table.columns, needed));
  }
}

void check_sparse(const WeightTable& table) {
  const std::vector<std::uint64_t>& start = table.row_start;
  const bool fits = start.size() == std::size_t{table.rows} + 1 && start.front() == 0 &&
                    std::is_sorted(start.begin(), start.end()) &&
                    start.back() == table.column.size() &&
                    table.column.size() == table.values.size();
  if (!fits) {
    throw ConfigurationError(
        with_code(Code::weights_differ,
                  "the sparse weights hold {} numbers, {} columns and {} row starts, which do "
                  "not describe {} "
                  "rows; write rows + 1 ascending row starts, and a column for each number",
                  table.values.size(), table.column.size(), start.size(), table.rows));
  }
  for (const std::uint32_t column : table.column) {
    if (column >= table.columns) {
      throw ConfigurationError(
          with_code(Code::weights_differ,
                    "the weights name column {}, but there are {} inputs; columns count from 0",
                    column, table.columns));
    }
  }
}

void check(const WeightTable& table) {
  if (table.kind == WeightTable::Kind::dense) {
    check_dense(table);
  } else if (table.kind == WeightTable::Kind::sparse) {
    check_sparse(table);
  }
  const auto bad = std::find_if(table.values.begin(), table.values.end(),
                                [](double weight) { return !std::isfinite(weight); });
  if (bad != table.values.end()) {
    throw ConfigurationError(with_code(Code::not_a_number,
                                       "weight {} of {} is not finite; write a number",
                                       bad - table.values.begin(), table.values.size()));
  }
}

}  // namespace

ParameterDescription weights_parameter() {
  return {
      .name = "weights",
      .type = ParameterType::weights,
      .default_value = "uniform",
      .text = "Weights, one row per output and one column per input; uniform: mean of all inputs"};
}

WeightTable port_weights(const NodeSetup& setup, std::uint32_t output_width,
                         std::uint32_t input_width, const std::string& key) {
  try {
    WeightTable table = setup.parameters.weights(key).resized(output_width, input_width);
    check(table);
    return table;
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(setup.parameters.where(key),
                             fmt::format("key '{}': {}", key, error.what()));
  }
}

}  // namespace spikeloop
