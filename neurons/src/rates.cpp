#include "rates.hpp"

#include <algorithm>
#include <cmath>

#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

// Adds weight times rate of every source to its targets.
void add_weighted(const NetworkProjection& projection, std::span<const double> weight,
                  std::span<const double> rates, std::span<double> sum) {
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const double rate = rates[i];
    for (std::uint64_t k = projection.row_start[i]; k < projection.row_start[i + 1]; ++k) {
      sum[projection.target[k]] += weight[k] * rate;
    }
  }
}

}  // namespace

Rates::Population::Population(const NetworkPopulation& of, std::size_t index_,
                              const RandomStream& stream_, TimeNs resolution)
    : index(index_),
      model(of.model),
      p(of.rate),
      size(of.size),
      stream(stream_),
      decay(std::exp(-p.lambda * in_ms(resolution) / p.tau)) {
  const double h = in_ms(resolution) / p.tau;
  gain = p.lambda > 0.0 ? -std::expm1(-p.lambda * h) / p.lambda : h;
  noise =
      p.sigma * std::sqrt(p.lambda > 0.0 ? -std::expm1(-2.0 * p.lambda * h) / (2.0 * p.lambda) : h);
  driven.assign(size, 0.0);
  sum.assign(size, 0.0);
  if (p.sigma > 0.0) {
    normals.assign(4 * size, 0.0);
  }
}

Rates::Rates(const NetworkFile& network, const Seeding& seeding)
    : place_(network.populations.size(), 0) {
  for (std::size_t i = 0; i < network.populations.size(); ++i) {
    const NetworkPopulation& population = network.populations[i];
    if (is_rate(population.model)) {
      place_[i] = populations_.size();
      populations_.emplace_back(population, i, seeding.stream(population), network.resolution);
    }
  }
  for (std::size_t i = 0; i < network.projections.size(); ++i) {
    if (is_rate(network.populations[network.projections[i].to].model)) {
      add_projection(i, network);
    }
  }
  for (Population& population : populations_) {
    population.history.assign(static_cast<std::size_t>(population.depth) * population.size,
                              population.p.rate);
  }
}

void Rates::add_projection(std::size_t index, const NetworkFile& network) {
  const NetworkProjection& projection = network.projections[index];
  Population& to = populations_[place_[projection.to]];
  if (!is_rate(network.populations[projection.from].model)) {
    to.signals.push_back({&projection, projection.from, 0, projection.weight});
    return;
  }
  const auto keep = [this](std::size_t population, std::int64_t steps) {
    std::int64_t& depth = populations_[population].depth;
    depth = std::max(depth, steps);
  };
  const std::size_t from = place_[projection.from];
  const std::int64_t delay = projection.delay / network.resolution;
  keep(from, delay + 2);  // X(t - delay) is read when X(t + h) is written
  to.inputs.push_back({&projection, from, delay, projection.weight});
  if (projection.plasticity) {
    const NetworkPlasticity& rule = *projection.plasticity;
    const std::int64_t trace = rule.trace_delay / network.resolution;
    keep(from, trace + 1);
    keep(place_[projection.to], trace);
    learners_.push_back({index, place_[projection.to], to.inputs.size() - 1, place_[rule.reward],
                         trace, rule.A * in_ms(network.resolution), rule.theta, rule.Wmin,
                         rule.Wmax});
  }
}

void Rates::set_signal(const Currents& currents) {
  for (Population& population : populations_) {
    std::ranges::fill(population.driven, 0.0);
    for (const Input& input : population.signals) {
      add_weighted(*input.projection, input.weight, currents.signal(input.source),
                   population.driven);
    }
  }
}

void Rates::advance(std::int64_t step) {
  for (Population& population : populations_) {
    collect(population, step);
    if (!population.normals.empty()) {
      draw(population, step);
    }
    move(population, step);
  }
  for (const Learner& learner : learners_) {
    learn(learner, step);
  }
  now_ = step;
}

// H at the begin of the step.
void Rates::collect(Population& population, std::int64_t step) {
  std::ranges::copy(population.driven, population.sum.begin());
  for (const Input& input : population.inputs) {
    Population& source = populations_[input.source];
    // Before time 0 the history has the initial rates.
    const std::int64_t time = step - 1 - input.delay + source.depth;
    add_weighted(*input.projection, input.weight, source.row(time), population.sum);
  }
}

// The number of a member and step is the same however the steps come.
void Rates::draw(Population& population, std::int64_t step) {
  const std::int64_t block = (step - 1) / 4;
  if (block == population.block) {
    return;
  }
  population.block = block;
  for (std::size_t i = 0; i < population.size; ++i) {
    const auto four = population.stream.normals(i, static_cast<std::uint64_t>(block));
    for (std::size_t k = 0; k < four.size(); ++k) {
      population.normals[k * population.size + i] = four[k];
    }
  }
}

void Rates::move(Population& population, std::int64_t step) {
  const RateParameters& p = population.p;
  const std::span<const double> before = population.row(step - 1);
  const std::span<double> after = population.row(step);
  const auto advance = [&](const auto& phi) {
    for (std::size_t i = 0; i < after.size(); ++i) {
      after[i] = population.decay * before[i] + population.gain * (p.mu + phi(population.sum[i]));
    }
  };
  switch (population.model) {
    case NeuronModel::threshold_lin_rate_ipn:
      advance([&p](double h) { return std::min(std::max(p.g * (h - p.theta), 0.0), p.alpha); });
      break;
    case NeuronModel::sigmoid_rate_ipn:
      advance([&p](double h) { return p.g / (1.0 + std::exp(-p.beta * (h - p.theta))); });
      break;
    default:
      advance([&p](double h) { return p.g * (h - p.theta); });
  }
  if (!population.normals.empty()) {
    const std::span<const double> normals =
        std::span(population.normals)
            .subspan(static_cast<std::size_t>((step - 1) % 4) * population.size, population.size);
    for (std::size_t i = 0; i < after.size(); ++i) {
      after[i] += population.noise * normals[i];
    }
  }
}

// As in the authors' NEST: a step from t - h to t sends the source's X(t - h), and what it sends
// has the weight that was learned with it. One step of trace is that rate, and the target's newest.
void Rates::learn(const Learner& learner, std::int64_t step) {
  Population& target = populations_[learner.target];
  Input& input = target.inputs[learner.input];
  Population& source = populations_[input.source];
  const std::span<const double> pre = source.row(step - learner.delay + source.depth);
  const std::span<const double> post = target.row(step - learner.delay + 1 + target.depth);
  const double factor = learner.rate * populations_[learner.reward].row(step)[0];
  const NetworkProjection& projection = *input.projection;
  for (std::size_t i = 0; i < pre.size(); ++i) {
    const double change = factor * pre[i];
    for (std::uint64_t k = projection.row_start[i]; k < projection.row_start[i + 1]; ++k) {
      if (post[projection.target[k]] > learner.theta) {
        input.weight[k] =
            std::min(std::max(input.weight[k] + change, learner.lowest), learner.highest);
      }
    }
  }
}

double Rates::rate(std::size_t population, std::uint32_t member) const {
  const Population& group = populations_[place_[population]];
  return group.history[static_cast<std::size_t>(now_ % group.depth) * group.size + member];
}

std::span<const double> Rates::learned(std::size_t projection) const {
  for (const Learner& learner : learners_) {
    if (learner.projection == projection) {
      return populations_[learner.target].inputs[learner.input].weight;
    }
  }
  return {};
}

}  // namespace spikeloop::neurons
