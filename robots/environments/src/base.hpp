// What all environments have in common.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "spikeloop/core/random.hpp"
#include "spikeloop/environments/environment.hpp"

namespace spikeloop::environments {

/// @throws ConfigurationError as Environment::step().
double checked_action(const Description& description, double action);

/// The random numbers of one episode.
class EpisodeRandom {
 public:
  EpisodeRandom(std::uint64_t seed, std::uint64_t episode)
      : stream_(seed, "environment"), episode_(episode) {}
  /// One of 0 .. count - 1; `count` is small.
  std::uint64_t choice(std::uint64_t count) { return stream_.bits(episode_, draw_++) % count; }
  /// Uniform in (low, high].
  double uniform(double low, double high) {
    return low + (high - low) * stream_.uniform(episode_, draw_++);
  }

 private:
  RandomStream stream_;
  std::uint64_t episode_;
  std::uint64_t draw_ = 0;
};

/// An environment whose state is what it shows.
template <std::size_t size>
class Base : public Environment {
 public:
  explicit Base(Description description) : description_(std::move(description)) {}

  const Description& description() const final { return description_; }
  void reset(std::uint64_t seed, std::uint64_t episode) final {
    random_ = EpisodeRandom(seed, episode);
    state_ = start();
  }
  Outcome step(double action) final { return advance(checked_action(description_, action)); }
  std::span<const double> observation() const final { return state_; }

 protected:
  using State = std::array<double, size>;
  virtual State start() = 0;
  /// A discrete action is one of 0 .. actions - 1.
  virtual Outcome advance(double action) = 0;

  State state_{};
  EpisodeRandom random_{0, 0};

 private:
  Description description_;
};

std::unique_ptr<Environment> make_cart_pole(const Options& options);
std::unique_ptr<Environment> make_frozen_lake(const Options& options);
std::unique_ptr<Environment> make_mountain_car(const Options& options);
std::unique_ptr<Environment> make_water_maze(const Options& options);
/// One in Python.
std::unique_ptr<Environment> make_script(const std::string& source);

}  // namespace spikeloop::environments
