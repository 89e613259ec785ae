// Counter-based random numbers: Philox4x64-10 (Salmon et al. 2011, Random123). Every number is a
// function of (seed, node's name, channel, draw index) alone: independent of ranks, threads, ticks
// and of the order in which channels are asked.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace spikeloop {

/// FNV-1a, 64 bit: the hash of a node's name that keys its streams.
std::uint64_t name_hash(std::string_view name);

/// What an episode of a run has in the place of the run's seed; the first one has that itself.
std::uint64_t episode_seed(std::uint64_t run, std::uint64_t episode);

/// The stream of one node; channels and draw indices address it freely.
/// Draw d of channel c is word d % 4 of Philox4x64-10 with key (seed, name_hash) and counter
/// (d / 4, c, purpose, 0). `purpose` keeps apart uses within one node.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view node_name, std::uint64_t purpose = 0);

  /// 64 uniformly distributed bits.
  std::uint64_t bits(std::uint64_t channel, std::uint64_t draw) const;
  /// Uniform in (0, 1]: never 0, so that its logarithm is finite; 53 bits.
  double uniform(std::uint64_t channel, std::uint64_t draw) const;
  /// uniform(first + channels[i], draws[i]) for all i, faster.
  void uniform(std::uint64_t first, std::span<const std::uint32_t> channels,
               std::span<const std::uint32_t> draws, std::span<double> numbers) const;
  /// Exponentially distributed with mean 1.
  double exponential(std::uint64_t channel, std::uint64_t draw) const;
  /// Independent standard normal numbers from draws 4 block .. 4 block + 3 (Box & Muller): with
  /// u = uniform(4 block), v = uniform(4 block + 1), the first two are sqrt(-2 ln u) times
  /// cos(2 pi v) and sin(2 pi v).
  std::array<double, 4> normals(std::uint64_t channel, std::uint64_t block) const;

 private:
  std::uint64_t seed_;
  std::uint64_t hash_;
  std::uint64_t purpose_;
};

}  // namespace spikeloop
