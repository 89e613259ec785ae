#include "plasticity.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

#include "simulation.hpp"

namespace spikeloop::neurons {

namespace {

double power(double base, double exponent) {
  return exponent == 1.0 ? base : exponent == 0.0 ? 1.0 : std::pow(base, exponent);
}

// Guetig et al. 2003, J. Neurosci. 23:3697: weights from 0 to Wmax, with a step that depends on
// them.
class TimingRule {
 public:
  TimingRule(const NetworkProjection& projection, double)
      : p_(*projection.plasticity), weights_(projection.weight) {}

  void facilitate(std::uint64_t k, double trace) {
    const double w = weights_[k] / p_.Wmax;
    const double up = w + p_.lambda * power(1.0 - w, p_.mu_plus) * trace;
    weights_[k] = up < 1.0 ? up * p_.Wmax : p_.Wmax;
  }
  void depress(std::uint64_t k, double trace) {
    const double w = weights_[k] / p_.Wmax;
    const double down = w - p_.alpha * p_.lambda * power(w, p_.mu_minus) * trace;
    weights_[k] = down > 0.0 ? down * p_.Wmax : 0.0;
  }
  void pass(std::uint64_t, std::int64_t, std::int64_t) {}
  void forget(std::int64_t) {}
  void reward_fired(std::int64_t) {}
  void reward_signal(double, std::int64_t) {}
  void bring_reward(std::int64_t) {}
  std::span<const double> weights() const { return weights_; }

 private:
  const NetworkPlasticity p_;
  std::vector<double> weights_;
};

// Pairs change an eligibility c, and dw/dt = c (n + r - b): dopamine n that jumps by 1 / tau_n at
// every rewarding spike, a rewarding signal r, a baseline b. Between two events c and n decay and r
// is constant, so that w has a closed form there; it is held to its bounds at every event.
class DopamineRule {
 public:
  DopamineRule(const NetworkProjection& projection, double step_ms)
      : p_(*projection.plasticity),
        h_(step_ms),
        both_(1.0 / p_.tau_c + 1.0 / p_.tau_n),
        weights_(projection.weight),
        eligibility_(projection.weight.size(), 0.0),
        level_{{0, 0.0, p_.b}} {}

  void facilitate(std::uint64_t k, double trace) { eligibility_[k] += p_.A_plus * trace; }
  void depress(std::uint64_t k, double trace) { eligibility_[k] -= p_.A_minus * trace; }

  // From t0 to t1.
  void pass(std::uint64_t k, std::int64_t t0, std::int64_t t1) {
    const double c = eligibility_[k];
    if (c == 0.0 || t1 <= t0) {
      return;
    }
    auto next = std::upper_bound(level_.begin(), level_.end(), t0,
                                 [](std::int64_t t, const Level& level) { return t < level.time; });
    double eligible = c;
    for (std::int64_t from = t0; from < t1;) {
      const Level& level = *(next - 1);
      const std::int64_t to = next == level_.end() ? t1 : std::min(t1, next->time);
      const bool whole = from == level.time && next != level_.end() && to == next->time;
      weights_[k] += eligible * (whole ? level.change : change(level, from, to));
      weights_[k] = std::clamp(weights_[k], p_.Wmin, p_.Wmax);
      eligible *= whole ? level.decay : decay(from, to);
      from = to;
      ++next;
    }
    eligibility_[k] = eligible;
  }

  void forget(std::int64_t time) {
    while (level_.size() > 1 && level_[1].time <= time) {
      level_.pop_front();
    }
  }

  void reward_fired(std::int64_t time) {
    coming_.insert(std::upper_bound(coming_.begin(), coming_.end(), time), time);
  }
  void reward_signal(double value, std::int64_t time) {
    bring_reward(time);
    add(time, 0.0, p_.b - value);
  }
  // Every rewarding spike up to `time` has its place in the course of the dopamine.
  void bring_reward(std::int64_t time) {
    for (; !coming_.empty() && coming_.front() <= time; coming_.pop_front()) {
      add(std::max(coming_.front(), level_.back().time), 1.0 / p_.tau_n, level_.back().baseline);
    }
  }

  std::span<const double> weights() const { return weights_; }

 private:
  // The dopamine right after an event, and what is taken from it until the next one. `change` and
  // `decay` are those of the time until then, so that a signal with a new value in every tick costs
  // a synapse two multiplications a tick in place of exponentials.
  struct Level {
    std::int64_t time;
    double n;
    double baseline;
    double change = 0.0;
    double decay = 1.0;
  };

  // Of an eligibility.
  double decay(std::int64_t from, std::int64_t to) const {
    return std::exp(static_cast<double>(from - to) * h_ / p_.tau_c);
  }
  // Of a weight between two times of a level, with an eligibility of 1 at `from`.
  double change(const Level& level, std::int64_t from, std::int64_t to) const {
    const double minus_dt = static_cast<double>(from - to) * h_;
    const double steady = level.baseline * p_.tau_c * std::expm1(minus_dt / p_.tau_c);
    if (level.n == 0.0) {
      return steady;
    }
    const double dopamine =
        level.n * std::exp(static_cast<double>(level.time - from) * h_ / p_.tau_n);
    return steady - dopamine / both_ * std::expm1(both_ * minus_dt);
  }

  void add(std::int64_t time, double jump, double baseline) {
    Level& last = level_.back();
    const double before = last.n * std::exp(static_cast<double>(last.time - time) * h_ / p_.tau_n);
    if (last.time == time) {
      last = {time, last.n + jump, baseline};
    } else {
      last.change = change(last, last.time, time);
      last.decay = decay(last.time, time);
      level_.push_back({time, before + jump, baseline});
    }
  }

  const NetworkPlasticity p_;
  const double h_;
  const double both_;
  std::vector<double> weights_;
  std::vector<double> eligibility_;
  std::deque<Level> level_;
  std::deque<std::int64_t> coming_;
};

// The spikes of one target that a source may still ask for, each with the trace behind it.
class PostHistory {
 public:
  struct Entry {
    std::int64_t time;
    double trace;
  };

  void add(std::int64_t time, double step_ms, const NetworkPlasticity& p) {
    const double before =
        p.nearest || entries_.empty()
            ? 0.0
            : entries_.back().trace * std::exp(static_cast<double>(entries_.back().time - time) *
                                               step_ms / p.tau_minus);
    entries_.push_back({time, before + 1.0});
  }
  // Those behind `time`.
  std::vector<Entry>::const_iterator behind(std::int64_t time) const {
    auto entry = entries_.end();
    while (entry != entries_.begin() && (entry - 1)->time > time) {
      --entry;
    }
    return entry;
  }
  std::vector<Entry>::const_iterator end() const { return entries_.end(); }
  // The trace of all spikes before `time`.
  double trace(std::int64_t time, double step_ms, double tau) const {
    const auto entry = behind(time - 1);
    return entry == entries_.begin()
               ? 0.0
               : (entry - 1)->trace *
                     std::exp(static_cast<double>((entry - 1)->time - time) * step_ms / tau);
  }
  // The last one up to `time` stays: its trace goes on.
  void forget(std::int64_t time) {
    const auto keep = behind(time);
    if (keep - entries_.begin() > 1) {
      entries_.erase(entries_.begin(), keep - 1);
    }
  }

 private:
  std::vector<Entry> entries_;
};

template <typename Rule>
class PairPlasticity final : public Plasticity {
 public:
  PairPlasticity(const NetworkProjection& projection, TimeNs resolution)
      : projection_(projection),
        p_(*projection.plasticity),
        h_(static_cast<double>(resolution) * 1e-6),
        delay_(projection.delay / resolution),
        rule_(projection, h_),
        sources_(projection.row_start.size() - 1),
        history_(1 + (projection.target.empty() ? 0
                                                : *std::max_element(projection.target.begin(),
                                                                    projection.target.end()))) {}

  std::span<const double> source_fired(std::uint32_t index, std::int64_t time) override {
    Source& source = sources_[index];
    time = std::max(time, source.settled);
    rule_.bring_reward(time);
    const std::uint64_t begin = projection_.row_start[index];
    const std::uint64_t end = projection_.row_start[index + 1];
    for (std::uint64_t k = begin; k < end; ++k) {
      const PostHistory& history = history_[projection_.target[k]];
      bring(k, source, history, time);
      rule_.depress(k, history.trace(time - delay_, h_, p_.tau_minus));
    }
    source.trace = p_.nearest ? 1.0 : source.trace * decay(source.last - time) + 1.0;
    source.last = time;
    source.settled = time;
    return rule_.weights().subspan(begin, end - begin);
  }

  void target_fired(std::uint32_t target, std::int64_t time) override {
    if (target < history_.size()) {
      history_[target].add(time, h_, p_);
    }
  }

  void reward_fired(std::int64_t time) override { rule_.reward_fired(time); }
  void reward_signal(double value, std::int64_t time) override { rule_.reward_signal(value, time); }

  void settle(std::int64_t time) override {
    rule_.bring_reward(time);
    for (std::uint32_t index = 0; index < sources_.size(); ++index) {
      Source& source = sources_[index];
      for (std::uint64_t k = projection_.row_start[index]; k < projection_.row_start[index + 1];
           ++k) {
        bring(k, source, history_[projection_.target[k]], time);
      }
      source.settled = std::max(source.settled, time);
    }
    for (PostHistory& history : history_) {
      history.forget(time - delay_);
    }
    rule_.forget(time);
  }

  std::span<const double> weights() const override { return rule_.weights(); }

 private:
  struct Source {
    double trace = 0.0;        // right behind the last spike
    std::int64_t last = 0;     // the last spike
    std::int64_t settled = 0;  // its synapses have everything up to here
  };

  double decay(std::int64_t minus_dt) const {
    return std::exp(static_cast<double>(minus_dt) * h_ / p_.tau_plus);
  }

  // The target's spikes that have reached the synapse since it was last looked at.
  void bring(std::uint64_t k, const Source& source, const PostHistory& history, std::int64_t time) {
    std::int64_t at = source.settled;
    for (auto entry = history.behind(source.settled - delay_);
         entry != history.end() && entry->time <= time - delay_; ++entry) {
      const std::int64_t arrival = entry->time + delay_;
      rule_.pass(k, at, arrival);
      at = arrival;
      if (source.trace != 0.0) {
        rule_.facilitate(k, source.trace * decay(source.last - arrival));
      }
    }
    rule_.pass(k, at, time);
  }

  const NetworkProjection& projection_;
  const NetworkPlasticity p_;
  const double h_;
  const std::int64_t delay_;
  Rule rule_;
  std::vector<Source> sources_;
  std::vector<PostHistory> history_;
};

}  // namespace

std::unique_ptr<Plasticity> make_plasticity(const NetworkProjection& projection,
                                            TimeNs resolution) {
  const TimeNs step = resolution == 0 ? 1 : resolution;
  if (projection.plasticity->rule == PlasticityRule::stdp) {
    return std::make_unique<PairPlasticity<TimingRule>>(projection, step);
  }
  return std::make_unique<PairPlasticity<DopamineRule>>(projection, step);
}

}  // namespace spikeloop::neurons
