#include "sources.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

constexpr double kTwoPi = 6.283185307179586476925;

class StepCurrent final : public CurrentSource {
 public:
  StepCurrent(const SourceParameters& source, TimeNs h) : steps_(source.steps), h_(h) {}

  bool changes(std::int64_t step) const override {
    return std::ranges::binary_search(steps_, (step - 1) * h_, {}, &TimedValue::time);
  }
  double value(std::uint32_t, std::int64_t step, double) const override {
    const auto next = std::ranges::upper_bound(steps_, (step - 1) * h_, {}, &TimedValue::time);
    return next == steps_.begin() ? 0.0 : (next - 1)->value;
  }

 private:
  const std::vector<TimedValue> steps_;
  const TimeNs h_;
};

// The membrane's response over a step to sin is known in closed form: with d = exp(-h / tau),
//   integral from 0 to h of exp(-(h - s) / tau) exp(i w (t + s)) ds
//     = exp(i w t) (exp(i w h) - d) / (1 / tau + i w),
// and (1 - d) tau is that of a constant 1.
class SineCurrent final : public CurrentSource {
 public:
  SineCurrent(const SourceParameters& source, TimeNs h) : p_(source), h_(h) {}

  bool changes(std::int64_t) const override { return true; }
  double value(std::uint32_t, std::int64_t step, double tau_m) const override {
    using namespace std::complex_literals;
    const double h = static_cast<double>(h_) * 1e-6;
    const double omega = kTwoPi * p_.frequency * 1e-3;  // 1/ms
    const double decay = std::exp(-h / tau_m);
    const std::complex<double> gain = (std::exp(1i * (omega * h)) - decay) /
                                      (1.0 / tau_m + 1i * omega) /
                                      (-std::expm1(-h / tau_m) * tau_m);
    const double cycles = p_.frequency * to_seconds((step - 1) * h_);
    const double phase = kTwoPi * (cycles - std::floor(cycles)) + p_.phase;
    return p_.offset + p_.amplitude * (gain * std::exp(1i * phase)).imag();
  }

 private:
  const SourceParameters p_;
  const TimeNs h_;
};

// Independent normal numbers, each held for dt (Box & Muller).
class NoiseCurrent final : public CurrentSource {
 public:
  NoiseCurrent(const SourceParameters& source, TimeNs h, const RandomStream& stream)
      : p_(source), steps_(source.dt / h), stream_(stream) {}

  bool changes(std::int64_t step) const override { return (step - 1) % steps_ == 0; }
  double value(std::uint32_t member, std::int64_t step, double) const override {
    const auto draw = 2 * static_cast<std::uint64_t>((step - 1) / steps_);
    const double radius = std::sqrt(2.0 * stream_.exponential(member, draw));
    return p_.mean + p_.std * radius * std::cos(kTwoPi * stream_.uniform(member, draw + 1));
  }

 private:
  const SourceParameters p_;
  const std::int64_t steps_;
  const RandomStream stream_;
};

class SignalCurrent final : public CurrentSource {
 public:
  explicit SignalCurrent(const std::vector<double>& values) : values_(values) {}
  bool changes(std::int64_t) const override { return false; }  // set_signal() knows
  double value(std::uint32_t member, std::int64_t, double) const override {
    return values_[member];
  }

 private:
  const std::vector<double>& values_;
};

}  // namespace

PoissonTrains::PoissonTrains(const NetworkPopulation& population, const RandomStream& stream)
    : stream_(stream),
      drawn_(population.size, 0),
      integral_(population.size, 0.0),
      next_(population.size) {
  double integral = 0.0;
  for (const TimedValue& entry : population.source.steps) {
    const double begin = to_seconds(entry.time);
    if (!pieces_.empty()) {
      integral += (begin - pieces_.back().begin_s) * pieces_.back().rate;
    }
    pieces_.push_back({begin, integral, entry.value});
  }
  for (std::uint32_t member = 0; member < population.size; ++member) {
    draw(member);
  }
}

void PoissonTrains::draw(std::uint32_t member) {
  integral_[member] += stream_.exponential(member, drawn_[member]++);
  next_[member] = time_of(integral_[member]);
}

TimeNs PoissonTrains::time_of(double integral) const {
  const auto next = std::ranges::upper_bound(pieces_, integral, {}, &Piece::integral);
  if (next == pieces_.begin() || (next - 1)->rate == 0.0) {
    return kNever;  // behind the last step
  }
  const Piece& piece = *(next - 1);
  const double ns = (piece.begin_s + (integral - piece.integral) / piece.rate) * 1e9;
  constexpr double kLatest = 9e18;
  return ns < kLatest ? std::max(TimeNs{1}, static_cast<TimeNs>(std::ceil(ns))) : kNever;
}

Currents::Currents(const NetworkFile& network, const Seeding& seeding)
    : sources_(network.populations.size()), signals_(network.populations.size()) {
  const TimeNs h = network.resolution;
  for (std::size_t i = 0; i < network.populations.size(); ++i) {
    const NetworkPopulation& population = network.populations[i];
    switch (population.model) {
      case NeuronModel::step_current:
        sources_[i] = std::make_unique<StepCurrent>(population.source, h);
        break;
      case NeuronModel::sine_current:
        sources_[i] = std::make_unique<SineCurrent>(population.source, h);
        break;
      case NeuronModel::noise_current:
        sources_[i] =
            std::make_unique<NoiseCurrent>(population.source, h, seeding.stream(population));
        break;
      case NeuronModel::signal_input:
        signals_[i].assign(population.size, 0.0);
        sources_[i] = std::make_unique<SignalCurrent>(signals_[i]);
        break;
      default:
        break;
    }
  }
  for (std::size_t to = 0; to < network.populations.size(); ++to) {
    if (!has_membrane(network.populations[to].model)) {
      continue;
    }
    Inflow inflow{to, network.populations[to].parameters.tau_m, {}};
    for (const NetworkProjection& projection : network.projections) {
      if (projection.to == to && sources_[projection.from]) {
        inflow.projections.push_back(&projection);
      }
    }
    if (!inflow.projections.empty()) {
      inflows_.push_back(std::move(inflow));
    }
  }
}

Currents::~Currents() = default;

void Currents::set_signal(std::span<const double> values) {
  for (std::vector<double>& signal : signals_) {
    const auto part = values.first(signal.size());
    fresh_ = fresh_ || !std::ranges::equal(signal, part);
    std::ranges::copy(part, signal.begin());
    values = values.subspan(signal.size());
  }
}

// A sum is made anew whenever one of its parts changes, so that it does not depend on what was
// before.
void Currents::flow(std::int64_t step, std::span<const std::unique_ptr<Group>> groups) {
  for (const Inflow& inflow : inflows_) {
    const bool changes = fresh_ || std::ranges::any_of(inflow.projections, [&](const auto* p) {
                           return sources_[p->from]->changes(step);
                         });
    if (!changes) {
      continue;
    }
    const std::span<double> current = groups[inflow.to]->current();
    std::ranges::fill(current, 0.0);
    for (const NetworkProjection* projection : inflow.projections) {
      const CurrentSource& source = *sources_[projection->from];
      for (std::uint32_t member = 0; member + 1 < projection->row_start.size(); ++member) {
        const double value = source.value(member, step, inflow.tau_m);
        const auto to = targets(*projection, member);
        const auto factor = weights(*projection, member);
        for (std::size_t k = 0; k < to.size(); ++k) {
          current[to[k]] += factor[k] * value;
        }
      }
    }
  }
  fresh_ = false;
}

double Currents::total(std::size_t population) const {
  double sum = 0.0;
  for (const double value : signals_[population]) {
    sum += value;
  }
  return sum;
}

}  // namespace spikeloop::neurons
