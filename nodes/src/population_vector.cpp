// `population_vector`: the mean of what the neurons prefer, weighted with their rates
// (Georgopoulos, Schwartz & Kettner 1986).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "kernel_sum.hpp"
#include "port_weights.hpp"
#include "preferred_values.hpp"
#include "spike_moments.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

constexpr double kSilent = 1e-100;  // less than this is left of all kernels: no rates
constexpr double kBalanced = 1e-9;  // less than this is left of the vectors: no direction
constexpr double kLargest = 1e100;  // of directions: their sums must be finite
constexpr std::size_t kSums = 3;    // of an output: rates, and their vectors' two components

// A value as the vector that is added up for it: itself, or its direction on a circle.
struct Vector {
  double x;
  double y;
};

class Circle {
 public:
  explicit Circle(const ValueRange& range) : range_(range) {}

  Vector vector_of(double value) const {
    if (!range_.circular) {
      return {value, 0};
    }
    const double angle = (value - range_.minimum) / range_.length() * 2 * std::numbers::pi;
    return {std::cos(angle), std::sin(angle)};
  }

  // NaN: the vectors cancel each other out.
  double value_of(const Vector& mean) const {
    if (!range_.circular) {
      return mean.x;
    }
    if (std::hypot(mean.x, mean.y) < kBalanced) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const double part = std::atan2(mean.y, mean.x) / (2 * std::numbers::pi);
    const double value = range_.minimum + (part < 0 ? part + 1 : part) * range_.length();
    return value < range_.maximum ? value : range_.minimum;
  }

 private:
  ValueRange range_;
};

WeightTable written_directions(const NodeSetup& setup) {
  WeightTable table = port_weights(setup, setup.widths[1], setup.widths[0], "directions");
  const auto refuse = [&](const std::string& reason) {
    throw ConfigurationError(setup.parameters.where("directions"),
                             fmt::format("key 'directions': {}", reason));
  };
  if (table.kind == WeightTable::Kind::uniform) {
    refuse(with_code(
        Code::weights_differ,
        "in a uniform table all neurons prefer the same; write a table with a row an output and "
        "a column a neuron, or even"));
  }
  for (const double value : table.values) {
    if (std::fabs(value) > kLargest) {
      refuse(with_code(Code::out_of_bounds, "{} is out of bounds; write values from {} to {}",
                       value, -kLargest, kLargest));
    }
  }
  return table;
}

// Which outputs each neuron counts for, and its vector there.
class Directions {
 public:
  explicit Directions(const NodeSetup& setup)
      : circle_(value_range(setup.parameters)), outputs_(setup.widths[1]) {
    if (setup.parameters.weights("directions").is_even()) {
      neurons_ = neurons_a_value(setup, 0, 1);
      for (const double value : preferred_values(value_range(setup.parameters), neurons_)) {
        vectors_.push_back(circle_.vector_of(value));
      }
      return;
    }
    const WeightTable table = written_directions(setup);
    for (std::uint32_t i = 0; i < table.columns; ++i) {
      for (std::uint32_t k = 0; k < table.rows; ++k) {
        vectors_.push_back(circle_.vector_of(table.at(k, i)));
      }
    }
  }

  // Calls `counts(output, vector)`.
  template <typename Counts>
  void of(std::uint32_t neuron, Counts&& counts) const {
    if (neurons_ > 0) {
      counts(neuron / neurons_, vectors_[neuron % neurons_]);
      return;
    }
    for (std::uint32_t k = 0; k < outputs_; ++k) {
      counts(k, vectors_[std::size_t{neuron} * outputs_ + k]);
    }
  }

  double value_of(const Vector& mean) const { return circle_.value_of(mean); }

 private:
  Circle circle_;
  std::uint32_t outputs_;
  std::uint32_t neurons_ = 0;    // of an output; 0: a table
  std::vector<Vector> vectors_;  // even: of an output's neurons; a table: neuron by neuron
};

class PopulationVector final : public Node {
 public:
  explicit PopulationVector(const NodeSetup& setup)
      : directions_(setup),
        sum_(static_cast<std::uint32_t>(kSums * setup.widths[1]), setup.parameters.number("tau")),
        values_(setup.widths[1], std::numeric_limits<double>::quiet_NaN()) {}

  void step(const Step& step) override {
    const SpikeInput input = step.spike_input();
    if (input.spikes.empty()) {
      return;
    }
    moments_.take(input, step.interval(),
                  [this](TimeNs time, std::span<const Spike> spikes) { add(time, spikes); });
    write(step.signal_output());
  }

  std::vector<Counter> counters() const override { return moments_.counters(); }

 private:
  void add(TimeNs time, std::span<const Spike> spikes) {
    sum_.prepare(moments_.latest());
    const double factor = sum_.factor(time);
    touched_.clear();
    for (const Spike& spike : spikes) {
      directions_.of(static_cast<std::uint32_t>(spike.channel),
                     [&](std::uint32_t k, const Vector& vector) {
                       sum_.add(kSums * k, factor);
                       sum_.add(kSums * k + 1, vector.x * factor);
                       sum_.add(kSums * k + 2, vector.y * factor);
                       if (touched_.empty() || touched_.back() < k) {
                         touched_.push_back(k);
                       }
                     });
    }
    // Without a spike of its own, an output must not even change by rounding.
    const double decay = sum_.decay(moments_.latest());
    for (const std::uint32_t k : touched_) {
      evaluate(k, decay);
    }
  }

  void evaluate(std::uint32_t k, double decay) {
    const double rates = sum_.value(kSums * k, decay);
    if (rates < kSilent) {
      return;
    }
    const double value = directions_.value_of(
        {sum_.value(kSums * k + 1, decay) / rates, sum_.value(kSums * k + 2, decay) / rates});
    values_[k] = std::isnan(value) ? values_[k] : value;
  }

  void write(const SignalOutput& output) {
    const bool valid =
        std::ranges::none_of(values_, [](double value) { return std::isnan(value); });
    if (valid && (output.revision() == 0 || !std::ranges::equal(values_, output.values()))) {
      std::ranges::copy(values_, output.values().begin());
      output.commit();
    }
  }

  Directions directions_;
  KernelSum sum_;
  SpikeMoments moments_;
  std::vector<double> values_;  // NaN: none yet
  std::vector<std::uint32_t> touched_;
};

}  // namespace

/// out[k] = sum_i r_i d_ki / sum_i r_i, where r_i is the rate of neuron i, filtered with an
/// exponential kernel, and d_ki what it prefers. All rates decay alike, so that the value changes
/// at spikes alone and is held between them.
///
/// `directions = even`: output k is decoded from the neurons k*n to k*n + n-1 alone, which prefer
/// evenly spaced values: the code of `population_encoder`. Else a table, a row an output and a
/// column a neuron; then every neuron counts for every output.
/// `circular`: values are angles, value_max is value_min, and out[k] is the angle of the sum of
/// vectors of length r_i and angle d_ki, in [value_min, value_max); where that sum is shorter than
/// 1e-9 of the sum of the lengths, the last value is held.
///
/// An output whose kernels add up to less than 1e-100 at the latest spike holds its last value.
/// `out` is invalid until every output has one.
NodeClass population_vector_class() {
  NodeDescription description;
  description.name = "population_vector";
  description.text = "Mean of the neurons' preferred values, weighted by their filtered rates";
  description.source = "Georgopoulos, Schwartz & Kettner 1986";
  description.ports = {
      {"in",
       PortKind::spikes,
       Direction::input,
       {},
       "One neuron per channel; with directions=even, a multiple of the output width"},
      {"out", PortKind::signal, Direction::output, {}, "One decoded value per channel"}};
  description.parameters = {
      kernel_tau_parameter(),
      {.name = "directions",
       .type = ParameterType::weights,
       .default_value = "even",
       .text = "Preferred values, one row per output and one column per neuron; even: evenly "
               "spaced, with the same number of neurons for each output"}};
  append_value_range(description.parameters);
  return {description,
          [](const NodeSetup& setup) { return std::make_unique<PopulationVector>(setup); }};
}

}  // namespace spikeloop
