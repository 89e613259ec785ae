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

RandomStream::RandomStream(std::uint64_t seed, std::string_view node_name, std::uint64_t purpose)
    : seed_(seed), hash_(name_hash(node_name)), purpose_(purpose) {}

std::uint64_t RandomStream::bits(std::uint64_t channel, std::uint64_t draw) const {
  const r123::Philox4x64::ctr_type counter = {{draw / 4, channel, purpose_, 0}};
  const r123::Philox4x64::key_type key = {{seed_, hash_}};
  return r123::Philox4x64()(counter, key)[draw % 4];
}

double RandomStream::uniform(std::uint64_t channel, std::uint64_t draw) const {
  return static_cast<double>((bits(channel, draw) >> 11U) + 1) * 0x1.0p-53;
}

double RandomStream::exponential(std::uint64_t channel, std::uint64_t draw) const {
  return -std::log(uniform(channel, draw));
}

}  // namespace spikeloop
