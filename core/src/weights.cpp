#include "spikeloop/core/weights.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

WeightTable WeightTable::dense(std::uint32_t rows, std::uint32_t columns,
                               std::vector<double> values) {
  WeightTable table;
  table.kind = Kind::dense;
  table.rows = rows;
  table.columns = columns;
  table.values = std::move(values);
  return table;
}

WeightTable WeightTable::uniform() {
  WeightTable table;
  table.kind = Kind::uniform;
  return table;
}

WeightTable WeightTable::uniform(double weight) {
  WeightTable table = uniform();
  table.values = {weight};
  return table;
}

WeightTable WeightTable::one_to_one(double weight) {
  WeightTable table;
  table.kind = Kind::one_to_one;
  table.values = {weight};
  return table;
}

WeightTable WeightTable::blocks(double weight) {
  WeightTable table;
  table.kind = Kind::blocks;
  table.values = {weight};
  return table;
}

namespace {

WeightTable sparse_blocks(double weight, std::uint32_t rows, std::uint32_t columns) {
  if (rows == 0 || columns % rows != 0) {
    throw ConfigurationError(
        with_code(Code::weights_differ,
                  "blocks need a number of inputs that is a multiple of the outputs, but there "
                  "are {} inputs and {} outputs; write such widths, or a weight file",
                  columns, rows));
  }
  const std::uint32_t length = columns / rows;
  WeightTable table;
  table.kind = WeightTable::Kind::sparse;
  table.rows = rows;
  table.columns = columns;
  table.row_start.push_back(0);
  for (std::uint32_t j = 0; j < columns; ++j) {
    table.column.push_back(j);
    table.values.push_back(weight / length);
    if ((j + 1) % length == 0) {
      table.row_start.push_back(table.column.size());
    }
  }
  return table;
}

}  // namespace

WeightTable WeightTable::even() {
  return {};
}

bool WeightTable::is_even() const {
  return kind == Kind::dense && rows == 0 && values.empty();
}

WeightTable WeightTable::resized(std::uint32_t output_width, std::uint32_t input_width) const {
  if (is_even()) {
    throw ConfigurationError(with_code(
        Code::weights_differ,
        "'even' stands for no weights here; write a weight file, 'uniform' or 'one_to_one'"));
  }
  const bool fits = (rows == 0 || rows == output_width) && (columns == 0 || columns == input_width);
  if (!fits) {
    throw ConfigurationError(
        with_code(Code::weights_differ,
                  "the weights have {} rows and {} columns, but the ports have {} outputs and {} "
                  "inputs; write one row an output and one column an input",
                  rows, columns, output_width, input_width));
  }
  if (kind == Kind::one_to_one && output_width != input_width) {
    throw ConfigurationError(
        with_code(Code::weights_differ,
                  "one-to-one weights need ports of one width, but there are {} outputs and {} "
                  "inputs; write a weight file instead",
                  output_width, input_width));
  }
  if (kind == Kind::blocks) {
    return sparse_blocks(values.empty() ? 1.0 : values[0], output_width, input_width);
  }
  WeightTable table = *this;
  table.rows = output_width;
  table.columns = input_width;
  if (kind == Kind::uniform && values.empty()) {
    table.values = {1.0 / input_width};
  }
  if (kind == Kind::one_to_one && values.empty()) {
    table.values = {1.0};
  }
  return table;
}

double WeightTable::at(std::uint32_t row_index, std::uint32_t column_index) const {
  switch (kind) {
    case Kind::dense:
      return values[std::size_t{row_index} * columns + column_index];
    case Kind::uniform:
      return values.empty() ? 1.0 / columns : values[0];
    case Kind::one_to_one:
      return row_index != column_index ? 0.0 : (values.empty() ? 1.0 : values[0]);
    case Kind::sparse: {
      const auto begin = column.begin() + static_cast<std::ptrdiff_t>(row_start[row_index]);
      const auto end = column.begin() + static_cast<std::ptrdiff_t>(row_start[row_index + 1]);
      const auto found = std::lower_bound(begin, end, column_index);
      return found != end && *found == column_index
                 ? values[static_cast<std::size_t>(found - column.begin())]
                 : 0.0;
    }
    case Kind::blocks:
      break;  // has no size
  }
  return 0.0;
}

WeightTable WeightTable::compressed() const {
  if (kind == Kind::sparse) {
    return *this;
  }
  WeightTable table;
  table.kind = Kind::sparse;
  table.rows = rows;
  table.columns = columns;
  table.row_start.push_back(0);
  for (std::uint32_t i = 0; i < rows; ++i) {
    const bool diagonal = kind == Kind::one_to_one;
    const std::uint32_t first = diagonal ? i : 0;
    const std::uint32_t last = diagonal ? i + 1 : columns;
    for (std::uint32_t j = first; j < last; ++j) {
      if (const double weight = at(i, j); weight != 0.0) {
        table.column.push_back(j);
        table.values.push_back(weight);
      }
    }
    table.row_start.push_back(table.column.size());
  }
  return table;
}

}  // namespace spikeloop
