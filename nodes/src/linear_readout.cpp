// `linear_readout`: filtered and weighted spikes (Weidel et al. 2016, linear readout decoder).
#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "kernel_sum.hpp"
#include "port_weights.hpp"
#include "spike_moments.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

// The weights by input channel, because spikes come by channel.
class TransposedWeights {
 public:
  // For the rows from `first` to `last`.
  TransposedWeights(const WeightTable& table, std::uint32_t first, std::uint32_t last)
      : kind_(table.kind), first_(first), rows_(last - first) {
    if (kind_ == WeightTable::Kind::dense) {
      transpose_dense(table);
    } else if (kind_ == WeightTable::Kind::sparse) {
      transpose_sparse(table);
    } else {
      values_ = table.values;
    }
  }

  // Sums that are kept: all outputs of a uniform table are one.
  std::uint32_t sums() const { return kind_ == WeightTable::Kind::uniform ? 1 : rows_; }

  // Adds a spike of `channel`; `factor` is its kernel.
  void add(std::uint32_t channel, double factor, KernelSum& sum) const {
    switch (kind_) {
      case WeightTable::Kind::dense:
        for (std::size_t i = 0; i < rows_; ++i) {
          sum.add(i, values_[std::size_t{channel} * rows_ + i] * factor);
        }
        return;
      case WeightTable::Kind::sparse:
        for (std::size_t k = start_[channel]; k < start_[channel + 1]; ++k) {
          sum.add(row_[k], values_[k] * factor);
        }
        return;
      case WeightTable::Kind::uniform:
        return sum.add(0, values_[0] * factor);
      case WeightTable::Kind::one_to_one:
        if (channel - first_ < rows_) {
          sum.add(channel - first_, values_[0] * factor);
        }
        return;
      case WeightTable::Kind::blocks:
        return;  // became sparse with its size
    }
  }

 private:
  void transpose_dense(const WeightTable& table) {
    values_.resize(std::size_t{rows_} * table.columns);
    for (std::size_t i = 0; i < rows_; ++i) {
      for (std::size_t j = 0; j < table.columns; ++j) {
        values_[j * rows_ + i] = table.values[(first_ + i) * table.columns + j];
      }
    }
  }

  void transpose_sparse(const WeightTable& table) {
    const std::uint64_t begin = table.row_start[first_];
    const std::uint64_t end = table.row_start[first_ + rows_];
    start_.assign(std::size_t{table.columns} + 1, 0);
    for (std::uint64_t k = begin; k < end; ++k) {
      ++start_[table.column[k] + 1];
    }
    for (std::size_t j = 0; j < table.columns; ++j) {
      start_[j + 1] += start_[j];
    }
    row_.resize(end - begin);
    values_.resize(end - begin);
    std::vector<std::uint64_t> next = start_;
    for (std::uint32_t i = 0; i < rows_; ++i) {
      for (std::size_t k = table.row_start[first_ + i]; k < table.row_start[first_ + i + 1]; ++k) {
        const std::uint64_t place = next[table.column[k]]++;
        row_[place] = i;
        values_[place] = table.values[k];
      }
    }
  }

  WeightTable::Kind kind_;
  std::uint32_t first_;
  std::uint32_t rows_;
  std::vector<double> values_;
  std::vector<std::uint64_t> start_;
  std::vector<std::uint32_t> row_;
};

/// Weights of spikes that were filtered with another time constant would decode something else.
void check_tau(const Parameters& parameters) {
  const double tau = parameters.number("tau");
  const double fitted = parameters.weights("weights").fitted_tau_s;
  if (fitted != 0 && std::abs(tau - fitted) > 1e-9 * fitted) {
    const bool given = parameters.given("tau");
    throw ConfigurationError(
        parameters.where(given ? "tau" : "weights"),
        with_code(Code::weight_file,
                  "key 'tau': {:g} ms, but the weights were fitted with {:g} ms; write  tau: {:g} "
                  "ms, fit them again with --tau {:g}, or write the list of weights alone into "
                  "their file",
                  tau * 1e3, fitted * 1e3, fitted * 1e3, tau));
  }
}

class LinearReadout final : public Node {
 public:
  explicit LinearReadout(const NodeSetup& setup)
      : tau_(setup.parameters.number("tau")),
        share_(setup.share),
        first_(share_.begin(setup.widths[1])),
        weights_(port_weights(setup, setup.widths[1], setup.widths[0]), first_,
                 share_.end(setup.widths[1])),
        sum_(weights_.sums(), tau_) {
    check_tau(setup.parameters);
  }

  void step(const Step& step) override {
    take(step.spike_input(), step.interval());
    write(step.signal_output(), step.interval().end);
  }

  std::vector<Counter> counters() const override {
    // All shares see all spikes.
    return {{"spikes", share_.index == 0 ? spikes_ : 0},
            {"late_spikes", share_.index == 0 ? late_ : 0}};
  }

 private:
  void take(const SpikeInput& input, const Interval& interval) {
    if (input.spikes.empty()) {
      return;
    }
    sum_.prepare(interval.end);
    // Spikes come in order of time, and many share one: simulators work on a grid.
    TimeNs time = input.spikes.front().time_ns;
    double factor = sum_.factor(time);
    for (const Spike& spike : input.spikes) {
      if (spike.time_ns != time) {
        time = spike.time_ns;
        factor = sum_.factor(time);
      }
      const auto channel = static_cast<std::uint32_t>(spike.channel);
      if (channel >= input.width) {
        refuse_channel(spike.channel, input.width);
      }
      weights_.add(channel, factor, sum_);
      late_ += time <= interval.begin ? 1 : 0;
    }
    spikes_ += input.spikes.size();
  }

  // A new revision only when a value differs from the one before, and at the first step.
  void write(const SignalOutput& output, TimeNs end) {
    const double decay = sum_.decay(end);
    const std::span<double> all = output.values();
    const std::span<double> values =
        all.subspan(first_, share_.count(static_cast<std::uint32_t>(all.size())));
    bool changed = !begun_;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = sum_.value(weights_.sums() == 1 ? 0 : i, decay) / tau_;
      if (!begun_ || value != values[i]) {
        values[i] = value;
        changed = true;
      }
    }
    if (changed) {
      output.commit();
    }
    begun_ = true;
  }

  double tau_;  // s
  Share share_;
  std::uint32_t first_;
  TransposedWeights weights_;
  KernelSum sum_;
  bool begun_ = false;
  std::uint64_t spikes_ = 0;
  std::uint64_t late_ = 0;
};

}  // namespace

/// out[i](t) = sum over spikes (s, j) with s <= t of weights[i][j] * exp(-(t - s) / tau) / tau,
/// evaluated at the interval's end; with weight 1, the firing rate in Hz. Late spikes count with
/// their true age. There is state per output, none per neuron.
NodeClass linear_readout_class() {
  NodeDescription description;
  description.name = "linear_readout";
  description.text = "Weighted sum of spikes that are filtered with an exponential kernel";
  description.source = "Weidel et al. 2016, linear readout decoder";
  description.ports = {
      {"in", PortKind::spikes, Direction::input, {}, "One neuron per column of the weights"},
      {"out", PortKind::signal, Direction::output, {}, "One value per row of the weights, in 1/s"}};
  description.parameters = {kernel_tau_parameter(), weights_parameter()};
  description.shareable = true;
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<LinearReadout>(setup); }};
}

}  // namespace spikeloop
