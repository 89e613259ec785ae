#include "sha256.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>

namespace spikeloop::messages {
namespace {

using Sha256State = std::array<std::uint32_t, 8>;

/// The first 32 bits behind the point of `root`(prime), for the first 64 primes: FIPS 180-4, 4.2.2
/// and 5.3.3. In whole numbers, by bisection: floor(2^32 p^(1/k)) is the greatest x with
/// x^k <= 2^(32 k) p, and x < 2^35 suffices.
constexpr std::array<std::uint32_t, 64> fractions_of_roots(int power) {
  __extension__ using Wide = unsigned __int128;
  std::array<std::uint32_t, 64> fractions{};
  std::size_t count = 0;
  for (std::uint64_t number = 2; count < fractions.size(); ++number) {
    bool prime = true;
    for (std::uint64_t divisor = 2; divisor * divisor <= number; ++divisor) {
      prime = prime && number % divisor != 0;
    }
    if (!prime) {
      continue;
    }
    const Wide target = Wide{number} << (32 * power);
    std::uint64_t root = 0;
    for (std::uint64_t bit = std::uint64_t{1} << 37; bit != 0; bit >>= 1) {
      Wide product = 1;
      for (int i = 0; i < power; ++i) {
        product *= root + bit;
      }
      root += product <= target ? bit : 0;
    }
    fractions[count++] = static_cast<std::uint32_t>(root);
  }
  return fractions;
}

constexpr std::array<std::uint32_t, 64> kCubeRoots = fractions_of_roots(3);
constexpr std::array<std::uint32_t, 64> kSquareRoots = fractions_of_roots(2);

void add_block(Sha256State& state, const unsigned char* block) {
  std::array<std::uint32_t, 64> words{};
  for (std::size_t i = 0; i < 64; ++i) {
    words[i / 4] = words[i / 4] << 8 | block[i];
  }
  for (std::size_t i = 16; i < 64; ++i) {
    const std::uint32_t a = words[i - 15];
    const std::uint32_t b = words[i - 2];
    words[i] = words[i - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3) + words[i - 7] +
               (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10);
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (std::size_t i = 0; i < 64; ++i) {
    const std::uint32_t first = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                                ((e & f) ^ (~e & g)) + kCubeRoots[i] + words[i];
    const std::uint32_t second =
        (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + first;
    d = c;
    c = b;
    b = a;
    a = first + second;
  }
  const Sha256State added = {a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < state.size(); ++i) {
    state[i] += added[i];
  }
}

}  // namespace

std::string sha256_hex(std::string_view text) {
  std::string padded(text);
  padded.push_back('\x80');
  while (padded.size() % 64 != 56) {
    padded.push_back('\0');
  }
  const std::uint64_t bits = 8 * std::uint64_t{text.size()};
  for (int shift = 56; shift >= 0; shift -= 8) {
    padded.push_back(static_cast<char>((bits >> shift) & 0xff));
  }
  Sha256State state{};
  for (std::size_t i = 0; i < state.size(); ++i) {
    state[i] = kSquareRoots[i];
  }
  for (std::size_t i = 0; i < padded.size(); i += 64) {
    add_block(state, reinterpret_cast<const unsigned char*>(padded.data()) + i);
  }
  std::string hex;
  for (const std::uint32_t word : state) {
    hex += fmt::format("{:08x}", word);
  }
  return hex;
}

}  // namespace spikeloop::messages
