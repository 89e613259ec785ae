// `discretize`: a position as the activity of place cells.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <vector>

#include "signal_function.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

class Discretize final : public SignalFunction {
 public:
  explicit Discretize(const NodeSetup& setup) : SignalFunction(setup) {
    try {
      read(setup.parameters.weights("grid"), setup.widths[1], setup.widths[0]);
    } catch (const ConfigurationError& error) {
      throw ConfigurationError(setup.parameters.where("grid"),
                               fmt::format("key 'grid': {}", error.what()));
    }
  }

 private:
  struct Axis {
    double centre;
    double sigma;
  };

  void read(const WeightTable& table, std::uint32_t cells, std::uint32_t dimensions) {
    if (table.kind != WeightTable::Kind::dense || table.rows != cells ||
        table.columns != 2 * dimensions) {
      throw ConfigurationError(
          with_code(Code::weights_differ,
                    "the grid has {} rows of {} numbers, but {} outputs and {} inputs need {} "
                    "rows of {}: a row a place cell, its centre and then its widths (sigma)",
                    table.rows, table.columns, cells, dimensions, cells, 2 * dimensions));
    }
    for (std::uint32_t i = 0; i < cells; ++i) {
      for (std::uint32_t j = 0; j < dimensions; ++j) {
        axes_.push_back({table.at(i, j), table.at(i, dimensions + j)});
        const auto& [centre, sigma] = axes_.back();
        if (!std::isfinite(centre) || !std::isfinite(sigma) || sigma <= 0) {
          throw ConfigurationError(
              with_code(Code::weights_differ,
                        "row {} has centre {} and sigma {} on axis {}; write finite numbers, and "
                        "sigma above 0",
                        i, centre, sigma, j));
        }
      }
    }
  }

  void apply(std::span<const double> x, std::span<double> y) const override {
    const Axis* axis = axes_.data();
    for (double& value : y) {
      double distance = 0;  // squared, in units of sigma
      for (const double position : x) {
        const double away = (position - axis->centre) / axis->sigma;
        distance += away * away;
        ++axis;
      }
      value = 2 * std::exp(-distance / 2) - 1;
    }
  }

  std::vector<Axis> axes_;  // cell by cell
};

}  // namespace

/// out[i] = 2 exp(-sum over j of ((in[j] - mu[i][j]) / sigma[i][j])^2 / 2) - 1: 1 at a cell's
/// centre, -1 far away. A row of `grid` is one cell: mu of every input channel, then sigma.
NodeClass discretize_class() {
  NodeDescription description = signal_function_description(
      {{.name = "grid",
        .type = ParameterType::weights,
        .text = "File of the place cells, one row per cell: centre, then widths (sigma); or "
                "{axes: [[first centre, last centre, number, width], ...]}, an axis for each "
                "input: all combinations of their centres"}});
  description.name = "discretize";
  description.text = "Encodes a position as the activity of place cells with Gaussian fields";
  description.source = "music-adapters, discretize adapter";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "One coordinate per channel"},
      {"out", PortKind::signal, Direction::output, {}, "One place cell per row of the grid"}};
  return {description, [](const NodeSetup& setup) { return std::make_unique<Discretize>(setup); }};
}

}  // namespace spikeloop
