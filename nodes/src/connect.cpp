// `connect`: a linear map between continuous signals.
#include <algorithm>
#include <utility>
#include <vector>

#include "lane_sum.hpp"
#include "port_weights.hpp"
#include "signal_function.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

// y = W x for the shapes of a table.
class LinearMap {
 public:
  explicit LinearMap(WeightTable table) : table_(std::move(table)) {}

  void apply(std::span<const double> x, std::span<double> y) const {
    switch (table_.kind) {
      case WeightTable::Kind::dense:
        return dense(x, y);
      case WeightTable::Kind::sparse:
        return sparse(x, y);
      case WeightTable::Kind::uniform:
        return uniform(x, y);
      case WeightTable::Kind::one_to_one:
        std::transform(x.begin(), x.end(), y.begin(),
                       [weight = table_.values[0]](double value) { return weight * value; });
        return;
      case WeightTable::Kind::blocks:
        return;  // became sparse with its size
    }
  }

 private:
  void dense(std::span<const double> x, std::span<double> y) const {
    for (std::size_t i = 0; i < y.size(); ++i) {
      LaneSum sum;
      sum.add_products({&table_.values[i * x.size()], x.size()}, x);
      y[i] = sum.total();
    }
  }

  void sparse(std::span<const double> x, std::span<double> y) const {
    for (std::size_t i = 0; i < y.size(); ++i) {
      LaneSum sum;
      for (std::size_t k = table_.row_start[i]; k < table_.row_start[i + 1]; ++k) {
        sum.add(table_.column[k], table_.values[k] * x[table_.column[k]]);
      }
      y[i] = sum.total();
    }
  }

  void uniform(std::span<const double> x, std::span<double> y) const {
    LaneSum sum;
    for (std::size_t j = 0; j < x.size(); ++j) {
      sum.add(j, x[j]);
    }
    std::fill(y.begin(), y.end(), table_.values[0] * sum.total());
  }

  WeightTable table_;
};

class Connect final : public SignalFunction {
 public:
  explicit Connect(const NodeSetup& setup)
      : SignalFunction(setup), map_(port_weights(setup, setup.widths[1], setup.widths[0])) {}

 private:
  void apply(std::span<const double> x, std::span<double> y) const override { map_.apply(x, y); }

  LinearMap map_;
};

}  // namespace

/// out[i] = sum over j of weights[i][j] * in[j], added in the order of LaneSum; for uniform
/// weights, the weight times the sum of all inputs.
NodeClass connect_class() {
  NodeDescription description = signal_function_description({weights_parameter()});
  description.name = "connect";
  description.text = "Multiplies a continuous signal by a weight matrix";
  description.source = "Weidel et al. 2016, connect adapter";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "One value per column of the weights"},
      {"out", PortKind::signal, Direction::output, {}, "One value per row of the weights"}};
  return {description, [](const NodeSetup& setup) { return std::make_unique<Connect>(setup); }};
}

}  // namespace spikeloop
