// Environments for reinforcement learning. Those that Gymnasium has, too, take the same steps as
// Gymnasium's.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::environments {

/// A number of an observation or an action: its name, with the unit where there is one (`x_m`,
/// `velocity_m_s`), and its range: what is scaled to [-1, 1]. It is finite, but for those in
/// Python. A value of an observation can be outside of it (cart_pole).
struct Quantity {
  std::string name;
  double low = 0;
  double high = 0;
};

struct Description {
  std::string name;                   ///< "mountain_car"
  std::string text;                   ///< one line
  std::string source;                 ///< where the equations are published
  std::vector<Quantity> observation;  ///< in the order of Environment::observation()
  std::vector<Quantity> action;       ///< one
  /// Discrete: the action is a whole number 0 .. actions - 1. Continuous: 0.
  std::uint32_t actions = 0;
  TimeNs step = 0;  ///< default of the simulated time of a step
  /// Steps after which the caller ends an episode: Gymnasium's time limit.
  std::uint64_t max_steps = 0;
  bool lasts = false;  ///< success is an episode that lasts until its time limit
};

struct Outcome {
  double reward = 0;
  bool terminated = false;  ///< the episode is over, before max_steps
  /// The goal was reached. Never where Description::lasts.
  bool success = false;
  bool truncated = false;  ///< the episode is over by a time limit of the environment's own
};

class Environment {
 public:
  virtual ~Environment() = default;
  virtual const Description& description() const = 0;
  /// A new episode; all that is random is a function of (seed, episode).
  virtual void reset(std::uint64_t seed, std::uint64_t episode) = 0;
  /// What follows a step that terminated the episode is undefined until reset(). A discrete action
  /// is rounded to the nearest whole number, halves away from zero. A continuous action is an
  /// angle: one outside its range has the same effect as the same direction within.
  /// @throws ConfigurationError when a discrete action is none of 0 .. actions - 1, and when an
  /// action is not finite; the state stays as it is.
  virtual Outcome step(double action) = 0;
  /// Valid until the next call of reset() or step().
  virtual std::span<const double> observation() const = 0;
};

/// All there are, in alphabetical order.
std::vector<Description> descriptions();

struct Options {
  /// frozen_lake: one step in three goes in the direction of the action, the others perpendicular
  /// to it. Gymnasium's default is true.
  bool slippery = false;
};

/// In episode 0 of seed 0. Options of other environments are ignored.
/// @param name of one that there is; or one in Python, with Gymnasium's interface:
/// FILE.py:FUNCTION, which makes it, or gymnasium:NAME
/// @throws ConfigurationError for an unknown name (did you mean), and when the function fails.
std::unique_ptr<Environment> make(std::string_view name, const Options& options = {});

}  // namespace spikeloop::environments
