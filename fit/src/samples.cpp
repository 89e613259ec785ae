#include "spikeloop/fit/samples.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop::fit {

namespace {

/// An encoder that is fed by hand.
class Driver {
 public:
  explicit Driver(const Encoder& encoder)
      : node_(encoder.node_class->create({.name = encoder.name,
                                          .seed = encoder.seed,
                                          .parameters = encoder.parameters,
                                          .widths = {encoder.dimensions, encoder.neurons}})),
        neurons_(encoder.neurons),
        input_(encoder.dimensions) {}

  void set(std::span<const double> input) {
    std::ranges::copy(input, input_.begin());
    ++revision_;
  }

  /// The spikes of the next `length`.
  std::span<const Spike> step(TimeNs length) {
    spikes_.clear();
    const spikeloop_signal_input in{input_.data(), revision_,
                                    static_cast<std::uint32_t>(input_.size()), 0};
    spikeloop_spike_output out{this, &append, 0, 0};
    const spikeloop_step data{time_, time_ + length, &in, nullptr, nullptr, &out, 1, 0, 0, 1};
    node_->step(Step(data));
    time_ += length;
    return spikes_;
  }
  TimeNs time() const { return time_; }

 private:
  static void append(void* sink, const Spike* spikes, std::uint64_t count) {
    auto& own = *static_cast<Driver*>(sink);
    for (const Spike& spike : std::span(spikes, count)) {
      if (spike.channel < 0 || static_cast<std::uint32_t>(spike.channel) >= own.neurons_) {
        throw ConfigurationError("the encoder fires on channel " + std::to_string(spike.channel) +
                                 ", but has channels 0 to " + std::to_string(own.neurons_ - 1));
      }
    }
    own.spikes_.insert(own.spikes_.end(), spikes, spikes + count);
  }

  std::unique_ptr<Node> node_;
  std::uint32_t neurons_;
  std::vector<double> input_;
  std::uint64_t revision_ = 0;
  TimeNs time_ = 0;
  std::vector<Spike> spikes_;
};

/// A standard normal number (Box & Muller 1958).
double normal(const RandomStream& stream, std::uint64_t channel, std::uint64_t draw) {
  return std::sqrt(-2 * std::log(stream.uniform(channel, 2 * draw))) *
         std::cos(2 * std::numbers::pi * stream.uniform(channel, 2 * draw + 1));
}

/// Equally likely everywhere in the ball; components beyond the bound are cut.
void draw_point(const RandomStream& stream, std::uint64_t index, const Encoder& encoder,
                std::span<double> point) {
  double squares = 0;
  for (std::size_t k = 0; k < point.size(); ++k) {
    point[k] = normal(stream, index, k);
    squares += point[k] * point[k];
  }
  const double part = stream.uniform(index, 2 * point.size());
  const double length = encoder.radius * std::pow(part, 1 / static_cast<double>(point.size()));
  for (double& component : point) {
    component = std::clamp(component * length / std::sqrt(squares), -encoder.bound, encoder.bound);
  }
}

/// A sum of sinusoids up to a frequency.
class Noise {
 public:
  Noise(const Encoder& encoder, double cutoff_Hz)
      : dimensions_(encoder.dimensions), radius_(encoder.radius), bound_(encoder.bound) {
    const RandomStream stream(encoder.seed, "band-limited noise");
    for (std::uint32_t k = 0; k < dimensions_; ++k) {
      for (std::uint64_t i = 0; i < kSinusoids; ++i) {
        frequencies_.push_back(cutoff_Hz * stream.uniform(k, 2 * i));
        phases_.push_back(2 * std::numbers::pi * stream.uniform(k, 2 * i + 1));
      }
    }
  }

  /// Cut to the radius and the bound.
  void at(double time_s, std::span<double> x) const {
    double squares = 0;
    for (std::uint32_t k = 0; k < dimensions_; ++k) {
      double sum = 0;
      for (std::size_t i = k * kSinusoids; i < (k + 1) * kSinusoids; ++i) {
        sum += std::sin(2 * std::numbers::pi * frequencies_[i] * time_s + phases_[i]);
      }
      x[k] = radius_ / 2 * sum * std::sqrt(2.0 / (kSinusoids * dimensions_));
      squares += x[k] * x[k];
    }
    const double scale = std::min(1.0, radius_ / std::sqrt(squares));
    for (double& component : x) {
      component = std::clamp(component * scale, -bound_, bound_);
    }
  }

 private:
  static constexpr std::size_t kSinusoids = 32;  // a dimension

  std::uint32_t dimensions_;
  double radius_;
  double bound_;
  std::vector<double> frequencies_;
  std::vector<double> phases_;
};

/// Of each neuron the inverse of its mean interval; 0 with fewer than two spikes.
void rates_of(std::span<const Spike> spikes, std::span<double> rates) {
  std::vector<TimeNs> first(rates.size(), -1);
  std::vector<TimeNs> last(rates.size(), -1);
  std::vector<std::uint32_t> intervals(rates.size(), 0);
  for (const Spike& spike : spikes) {
    const auto n = static_cast<std::size_t>(spike.channel);
    if (first[n] < 0) {
      first[n] = last[n] = spike.time_ns;
      continue;
    }
    first[n] = std::min(first[n], spike.time_ns);
    last[n] = std::max(last[n], spike.time_ns);
    ++intervals[n];
  }
  for (std::size_t n = 0; n < rates.size(); ++n) {
    rates[n] = intervals[n] == 0 ? 0.0 : intervals[n] / to_seconds(last[n] - first[n]);
  }
}

}  // namespace

double settling_time_s(const RunSettings& settings) {
  return 5 * settings.tau_s;  // then the kernel has forgotten its beginning
}

void sample_rates(const Encoder& encoder, std::uint32_t points, std::uint64_t stream,
                  const Function& function, std::uint32_t outputs, const TakeSample& take) {
  constexpr TimeNs kSettle = 200'000'000;   // the transient after a change
  constexpr TimeNs kMeasure = 800'000'000;  // slower neurons count as silent
  const RandomStream random(encoder.seed, "points of the represented space", stream);
  Driver driver(encoder);
  std::vector<double> input(encoder.dimensions);
  std::vector<double> rates(encoder.neurons);
  std::vector<double> targets(outputs);
  for (std::uint32_t i = 0; i < points; ++i) {
    draw_point(random, i, encoder, input);
    driver.set(input);
    driver.step(kSettle);
    rates_of(driver.step(kMeasure), rates);
    function(input, targets);
    take({0, input, rates, targets});
  }
}

FilteredSpikes::FilteredSpikes(std::uint32_t neurons, double tau_s)
    : tau_(tau_s * 1e9), sums_(neurons, 0.0) {}

void FilteredSpikes::advance(const Interval& interval, std::span<const Spike> spikes) {
  const double decay = std::exp(-static_cast<double>(interval.end - interval.begin) / tau_);
  for (double& sum : sums_) {
    sum *= decay;
  }
  for (const Spike& spike : spikes) {
    sums_[static_cast<std::size_t>(spike.channel)] +=
        std::exp(-static_cast<double>(interval.end - spike.time_ns) / tau_) * 1e9 / tau_;
  }
}

namespace {

/// Filters the targets as the spikes, and takes a sample now and then.
class Sampling {
 public:
  Sampling(const RunSettings& settings, const Function& function, std::uint32_t neurons,
           std::uint32_t outputs)
      : settings_(settings),
        function_(function),
        keep_(std::exp(-to_seconds(settings.tick) / settings.tau_s)),
        settled_(static_cast<std::uint64_t>(settling_time_s(settings) / to_seconds(settings.tick))),
        filtered_(neurons, settings.tau_s),
        wanted_(outputs),
        targets_(outputs, 0.0) {}

  /// A tick with this input and these spikes.
  void advance(const Interval& interval, std::span<const double> input,
               std::span<const Spike> spikes, const TakeSample& take) {
    filtered_.advance(interval, spikes);
    function_(input, wanted_);
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      targets_[i] = wanted_[i] + (targets_[i] - wanted_[i]) * keep_;
    }
    if (ticks_ >= settled_ && ticks_ % settings_.every == 0) {
      take({to_seconds(interval.end), input, filtered_.activities(), targets_});
    }
    ++ticks_;
  }

 private:
  RunSettings settings_;
  const Function& function_;
  double keep_;            // of a filtered target, over a tick
  std::uint64_t settled_;  // ticks until the kernel's beginning is forgotten
  FilteredSpikes filtered_;
  std::vector<double> wanted_;
  std::vector<double> targets_;
  std::uint64_t ticks_ = 0;
};

}  // namespace

void sample_spikes(const Encoder& encoder, const RunSettings& settings, const Function& function,
                   std::uint32_t outputs, const TakeSample& take) {
  const double tick_s = to_seconds(settings.tick);
  const auto ticks = static_cast<std::uint64_t>(settings.duration_s / tick_s);
  const Noise noise(encoder, settings.cutoff_Hz);
  Driver driver(encoder);
  Sampling sampling(settings, function, encoder.neurons, outputs);
  std::vector<double> input(encoder.dimensions);
  for (std::uint64_t k = 0; k < ticks; ++k) {
    noise.at(static_cast<double>(k) * tick_s, input);
    driver.set(input);
    const TimeNs begin = driver.time();
    const auto spikes = driver.step(settings.tick);
    sampling.advance({begin, driver.time()}, input, spikes, take);
  }
}

void sample_recording(const Recording& recording, const RunSettings& settings,
                      const Function& function, std::uint32_t outputs, const TakeSample& take) {
  if (recording.times.empty()) {
    throw ConfigurationError("the recorded target has no value; record a run in which it has one");
  }
  const auto bad =
      std::ranges::find_if_not(recording.values, [](double value) { return std::isfinite(value); });
  if (bad != recording.values.end()) {
    const auto row = static_cast<std::size_t>(bad - recording.values.begin()) / recording.width;
    throw ConfigurationError("the recorded target has the value " + std::to_string(*bad) + " at " +
                             std::to_string(to_seconds(recording.times[row])) +
                             " s; record a signal of finite numbers");
  }
  std::vector<Spike> sorted(recording.spikes.begin(), recording.spikes.end());
  std::ranges::sort(sorted, spike_before);
  Sampling sampling(settings, function, recording.neurons, outputs);
  auto spike = sorted.begin();
  std::size_t row = 0;
  TimeNs begin = recording.times[0];
  spike = std::find_if(spike, sorted.end(), [&](const Spike& s) { return s.time_ns > begin; });
  for (; begin + settings.tick <= recording.end; begin += settings.tick) {
    const TimeNs end = begin + settings.tick;
    while (row + 1 < recording.times.size() && recording.times[row + 1] <= begin) {
      ++row;
    }
    const auto last =
        std::find_if(spike, sorted.end(), [&](const Spike& s) { return s.time_ns > end; });
    sampling.advance({begin, end}, recording.values.subspan(row * recording.width, recording.width),
                     {spike, last}, take);
    spike = last;
  }
}

}  // namespace spikeloop::fit
