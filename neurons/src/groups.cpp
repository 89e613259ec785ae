#include <algorithm>

#include "group.hpp"
#include "propagators.hpp"
#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

// What both integrate-and-fire models share. Potentials are kept relative to E_L, as in NEST.
class Membranes : public Group {
 protected:
  Membranes(const NetworkPopulation& population, TimeNs resolution)
      : h_(in_ms(resolution)),
        p_(population.parameters),
        threshold_(p_.V_th - p_.E_L),
        reset_(p_.V_reset - p_.E_L),
        refractory_steps_(refractory_steps(p_, resolution)),
        decay_(decay(h_, p_.tau_m)),
        constant_to_membrane_(constant_to_membrane(h_, p_.tau_m, p_.C_m)),
        driven_(p_.I_e * constant_to_membrane_),
        potential_(population.size, p_.V_m - p_.E_L),
        refractory_(population.size, 0) {}

  std::span<double> current() override {
    current_.resize(potential_.size(), 0.0);
    return current_;
  }
  double potential(std::uint32_t i) const override { return potential_[i] + p_.E_L; }

  // Calls `advance` with what constant currents add to a neuron's potential over the step: apart
  // for networks without other currents than I_e, whose loop is the faster for it.
  template <typename Advance>
  void with_currents(Advance&& advance) const {
    if (current_.empty()) {
      advance([driven = driven_](std::uint32_t) { return driven; });
    } else {
      advance([this](std::uint32_t i) { return driven_ + constant_to_membrane_ * current_[i]; });
    }
  }

  // A call a neuron and step would cost as much as the neuron.
  [[gnu::always_inline]] inline void fire_above_threshold(std::uint32_t i,
                                                          std::vector<std::uint32_t>& fired) {
    if (potential_[i] >= threshold_) {
      potential_[i] = reset_;
      refractory_[i] = refractory_steps_;
      fired.push_back(i);
    }
  }

  const double h_;
  const NeuronParameters p_;
  const double threshold_;
  const double reset_;
  const long refractory_steps_;
  const double decay_;
  const double constant_to_membrane_;
  const double driven_;
  std::vector<double> current_;  // pA; empty while nothing flows
  std::vector<double> potential_;
  std::vector<long> refractory_;  // steps left
};

// A spike makes the membrane potential jump by its weight; in the refractory period it is lost.
class DeltaNeurons final : public Membranes {
 public:
  DeltaNeurons(const NetworkPopulation& population, TimeNs resolution, std::int64_t longest_delay)
      : Membranes(population, resolution),
        lowest_(p_.V_min - p_.E_L),
        arriving_(population.size, longest_delay) {}

  void receive(std::int64_t step, std::span<const std::uint32_t> targets,
               std::span<const double> weights) override {
    const std::span<double> row = arriving_.row(step);
    for (std::size_t k = 0; k < targets.size(); ++k) {
      row[targets[k]] += weights[k];
    }
  }

  void update(std::int64_t step, std::vector<std::uint32_t>& fired) override {
    with_currents([&](const auto& driven) { advance(step, driven, fired); });
  }

 private:
  template <typename Driven>
  void advance(std::int64_t step, Driven driven, std::vector<std::uint32_t>& fired) {
    const std::span<double> row = arriving_.row(step);
    for (std::uint32_t i = 0; i < potential_.size(); ++i) {
      if (refractory_[i] == 0) {
        potential_[i] = std::max(decay_ * potential_[i] + driven(i) + row[i], lowest_);
      } else {
        --refractory_[i];
      }
      row[i] = 0.0;
      fire_above_threshold(i, fired);
    }
  }

  const double lowest_;
  RingBuffer arriving_;
};

// A spike makes a current jump by its weight, which decays with tau_syn_ex (weight >= 0) or
// tau_syn_in; the currents go on in the refractory period.
class ExpNeurons final : public Membranes {
 public:
  ExpNeurons(const NetworkPopulation& population, TimeNs resolution, std::int64_t longest_delay)
      : Membranes(population, resolution),
        decay_ex_(decay(h_, p_.tau_syn_ex)),
        decay_in_(decay(h_, p_.tau_syn_in)),
        ex_to_membrane_(current_to_membrane(h_, p_.tau_m, p_.tau_syn_ex, p_.C_m)),
        in_to_membrane_(current_to_membrane(h_, p_.tau_m, p_.tau_syn_in, p_.C_m)),
        current_ex_(population.size, 0.0),
        current_in_(population.size, 0.0),
        arriving_ex_(population.size, longest_delay),
        arriving_in_(population.size, longest_delay) {}

  void receive(std::int64_t step, std::span<const std::uint32_t> targets,
               std::span<const double> weights) override {
    const std::span<double> ex = arriving_ex_.row(step);
    const std::span<double> in = arriving_in_.row(step);
    for (std::size_t k = 0; k < targets.size(); ++k) {
      (weights[k] >= 0.0 ? ex : in)[targets[k]] += weights[k];
    }
  }

  void update(std::int64_t step, std::vector<std::uint32_t>& fired) override {
    with_currents([&](const auto& driven) { advance(step, driven, fired); });
  }

 private:
  template <typename Driven>
  void advance(std::int64_t step, Driven driven, std::vector<std::uint32_t>& fired) {
    const std::span<double> ex = arriving_ex_.row(step);
    const std::span<double> in = arriving_in_.row(step);
    for (std::uint32_t i = 0; i < potential_.size(); ++i) {
      if (refractory_[i] == 0) {
        potential_[i] = decay_ * potential_[i] + ex_to_membrane_ * current_ex_[i] +
                        in_to_membrane_ * current_in_[i] + driven(i);
      } else {
        --refractory_[i];
      }
      current_ex_[i] = decay_ex_ * current_ex_[i] + ex[i];
      current_in_[i] = decay_in_ * current_in_[i] + in[i];
      ex[i] = 0.0;
      in[i] = 0.0;
      fire_above_threshold(i, fired);
    }
  }

  const double decay_ex_;
  const double decay_in_;
  const double ex_to_membrane_;
  const double in_to_membrane_;
  std::vector<double> current_ex_;
  std::vector<double> current_in_;
  RingBuffer arriving_ex_;
  RingBuffer arriving_in_;
};

// Every spike that arrives leaves at once. A calendar instead of a ring buffer: a step costs what
// arrives in it, however many repeaters there are.
class Repeaters final : public Group {
 public:
  explicit Repeaters(std::int64_t longest_delay)
      : calendar_(static_cast<std::size_t>(longest_delay) + 1) {}

  void receive(std::int64_t step, std::span<const std::uint32_t> targets,
               std::span<const double>) override {
    auto& day = on(step);
    day.insert(day.end(), targets.begin(), targets.end());
  }

  void update(std::int64_t step, std::vector<std::uint32_t>& fired) override {
    auto& day = on(step);
    fired.insert(fired.end(), day.begin(), day.end());
    day.clear();
  }

 private:
  std::vector<std::uint32_t>& on(std::int64_t step) {
    return calendar_[static_cast<std::size_t>(step) % calendar_.size()];
  }

  std::vector<std::vector<std::uint32_t>> calendar_;
};

}  // namespace

std::unique_ptr<Group> make_group(const NetworkPopulation& population, TimeNs resolution,
                                  std::int64_t longest_delay) {
  switch (population.model) {
    case NeuronModel::repeater:
      return std::make_unique<Repeaters>(longest_delay);
    case NeuronModel::iaf_psc_delta:
      return std::make_unique<DeltaNeurons>(population, resolution, longest_delay);
    case NeuronModel::iaf_psc_exp:
      return std::make_unique<ExpNeurons>(population, resolution, longest_delay);
    default:
      return nullptr;  // what drives the others
  }
}

}  // namespace spikeloop::neurons
