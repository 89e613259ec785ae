#include "spikeloop/core/random.hpp"

#include <Random123/philox.h>

#include <cmath>

namespace spikeloop {

std::uint64_t name_hash(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  return hash;
}

std::uint64_t episode_seed(std::uint64_t run, std::uint64_t episode) {
  return episode == 1 ? run : RandomStream(run, "episode").bits(0, episode);
}

RandomStream::RandomStream(std::uint64_t seed, std::string_view node_name, std::uint64_t purpose)
    : seed_(seed), hash_(name_hash(node_name)), purpose_(purpose) {}

namespace {

[[gnu::always_inline]] inline std::uint64_t word(const r123::Philox4x64::key_type& key,
                                                 std::uint64_t purpose, std::uint64_t channel,
                                                 std::uint64_t draw) {
  const r123::Philox4x64::ctr_type counter = {{draw / 4, channel, purpose, 0}};
  return r123::Philox4x64()(counter, key)[draw % 4];
}

inline double to_uniform(std::uint64_t bits) {
  return static_cast<double>((bits >> 11U) + 1) * 0x1.0p-53;
}

}  // namespace

std::uint64_t RandomStream::bits(std::uint64_t channel, std::uint64_t draw) const {
  return word({{seed_, hash_}}, purpose_, channel, draw);
}

double RandomStream::uniform(std::uint64_t channel, std::uint64_t draw) const {
  return to_uniform(bits(channel, draw));
}

void RandomStream::uniform(std::uint64_t first, std::span<const std::uint32_t> channels,
                           std::span<const std::uint32_t> draws, std::span<double> numbers) const {
  const r123::Philox4x64::key_type key = {{seed_, hash_}};
  // Inlined here, the processor works on several numbers at once.
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = to_uniform(word(key, purpose_, first + channels[i], draws[i]));
  }
}

double RandomStream::exponential(std::uint64_t channel, std::uint64_t draw) const {
  return -std::log(uniform(channel, draw));
}

std::array<double, 4> RandomStream::normals(std::uint64_t channel, std::uint64_t block) const {
  constexpr double kTwoPi = 6.283185307179586476925;
  const r123::Philox4x64::ctr_type counter = {{block, channel, purpose_, 0}};
  const auto words = r123::Philox4x64()(counter, {{seed_, hash_}});
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < numbers.size(); i += 2) {
    const double radius = std::sqrt(-2.0 * std::log(to_uniform(words[i])));
    const double angle = kTwoPi * to_uniform(words[i + 1]);
    numbers[i] = radius * std::cos(angle);
    numbers[i + 1] = radius * std::sin(angle);
  }
  return numbers;
}

}  // namespace spikeloop
