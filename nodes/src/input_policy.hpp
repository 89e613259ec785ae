// What a node does with input values that it should not get: outside [-1, 1], NaN, infinite.
// Every node with a continuous input treats them here, in one way and under the same keys.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Appends `out_of_range` and `not_finite`.
void append_encoder_input_policy(std::vector<ParameterDescription>& parameters);
/// Appends `not_finite` alone, for nodes that take any finite value.
void append_finite_input_policy(std::vector<ParameterDescription>& parameters);

class InputPolicy {
 public:
  /// Reads the keys that one of the functions above declared.
  explicit InputPolicy(const NodeSetup& setup);

  /// The value that takes the place of `value`; NaN: hold, that is, leave the channel as it was.
  /// Call it once per channel and revision: it counts.
  /// @throws std::runtime_error under the policies `error`; the graph adds the node's name.
  double treat(double value, std::size_t channel) {
    // One comparison, false for NaN, is all that good values cost.
    return std::fabs(value) <= limit_ ? value : treat_unusual(value, channel);
  }

  /// True when `out_of_range = pass`, or when the node takes any finite value.
  bool passes() const { return range_ == Range::pass; }

  /// Appends inputs_clipped (where values are clipped at all) and inputs_not_finite.
  void append_counters(std::vector<Counter>& counters) const;

 private:
  enum class Range { clip, pass, error };
  enum class NotFinite { hold, zero, error };

  double treat_unusual(double value, std::size_t channel);
  double treat_not_finite(double value, std::size_t channel);

  bool has_range_;
  Range range_ = Range::pass;
  NotFinite not_finite_ = NotFinite::hold;
  double limit_;
  std::uint64_t clipped_count_ = 0;
  std::uint64_t not_finite_count_ = 0;
};

}  // namespace spikeloop
