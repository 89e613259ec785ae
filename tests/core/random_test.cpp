#include "spikeloop/core/random.hpp"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <cmath>

namespace spikeloop {
namespace {

// Random123's published known answers (tests/kat_vectors, philox4x64 10).
TEST(Philox, EqualsRandom123sKnownAnswers) {
  const r123::Philox4x64 philox;
  const auto zero = philox({{0, 0, 0, 0}}, {{0, 0}});
  EXPECT_EQ(zero[0], 0x16554d9eca36314cULL);
  EXPECT_EQ(zero[1], 0xdb20fe9d672d0fdcULL);
  EXPECT_EQ(zero[2], 0xd7e772cee186176bULL);
  EXPECT_EQ(zero[3], 0x7e68b68aec7ba23bULL);
  const auto pi = philox({{0x243f6a8885a308d3ULL, 0x13198a2e03707344ULL, 0xa4093822299f31d0ULL,
                           0x082efa98ec4e6c89ULL}},
                         {{0x452821e638d01377ULL, 0xbe5466cf34e90c6cULL}});
  EXPECT_EQ(pi[0], 0xa528f45403e61d95ULL);
  EXPECT_EQ(pi[3], 0x57bd43b5e52b7fe6ULL);
}

TEST(NameHash, IsFnv1a) {
  EXPECT_EQ(name_hash(""), 0xcbf29ce484222325ULL);
  EXPECT_EQ(name_hash("a"), 0xaf63dc4c8601ec8cULL);
  EXPECT_EQ(name_hash("encoder"), 0x8b21471fd8aec12fULL);
}

// Computed by an independent implementation (Python integers) of the documented mapping.
TEST(RandomStream, EqualsTheKnownAnswerTable) {
  struct Row {
    std::uint64_t seed;
    const char* name;
    std::uint64_t purpose, channel, draw, bits;
  };
  constexpr Row kTable[] = {
      {1, "encoder", 0, 0, 0, 0x2c6e6f9a87d88979ULL},
      {1, "encoder", 0, 0, 5, 0xbe5056f2bee2679eULL},
      {1, "encoder", 0, 3, 2, 0x350271ef45340805ULL},
      {2, "encoder", 0, 3, 2, 0x3fb1308a6121941cULL},
      {1, "decoder", 0, 3, 2, 0x5c0a91511d0e7025ULL},
      {1, "encoder", 7, 3, 2, 0xa9f573a2cb3dd734ULL},
      {0xffffffffffffffffULL, "", 0, 1099511627776ULL, 1125899906842627ULL, 0x1e5a73ebaea572daULL}};
  for (const Row& row : kTable) {
    EXPECT_EQ(RandomStream(row.seed, row.name, row.purpose).bits(row.channel, row.draw), row.bits);
  }
}

TEST(RandomStream, UniformIsInTheHalfOpenUnitIntervalWithTheRightMoments) {
  const RandomStream stream(1, "moments");
  constexpr int kDraws = 200'000;
  double sum = 0.0;
  double square = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double u =
        stream.uniform(static_cast<std::uint64_t>(i % 7), static_cast<std::uint64_t>(i));
    ASSERT_GT(u, 0.0);
    ASSERT_LE(u, 1.0);
    sum += u;
    square += u * u;
  }
  const double error = 4.0 / std::sqrt(12.0 * kDraws);
  EXPECT_NEAR(sum / kDraws, 0.5, error);
  EXPECT_NEAR(square / kDraws, 1.0 / 3.0, 4.0 * std::sqrt(4.0 / 45.0 / kDraws));
}

TEST(RandomStream, ExponentialHasMeanAndVarianceOne) {
  const RandomStream stream(1, "exponential");
  constexpr int kDraws = 200'000;
  double sum = 0.0;
  double square = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double e = stream.exponential(0, static_cast<std::uint64_t>(i));
    sum += e;
    square += e * e;
  }
  EXPECT_NEAR(sum / kDraws, 1.0, 4.0 / std::sqrt(kDraws));
  EXPECT_NEAR(square / kDraws, 2.0, 4.0 * std::sqrt(20.0 / kDraws));
}

TEST(RandomStream, NormalsComeFromTheDrawsOfTheirBlock) {
  constexpr double kTwoPi = 6.283185307179586;
  const RandomStream stream(3, "normals");
  for (const std::uint64_t block : {0, 1, 1000}) {
    const auto numbers = stream.normals(2, block);
    for (std::size_t i = 0; i < 4; i += 2) {
      const double radius = std::sqrt(2.0 * stream.exponential(2, 4 * block + i));
      const double angle = kTwoPi * stream.uniform(2, 4 * block + i + 1);
      EXPECT_DOUBLE_EQ(numbers[i], radius * std::cos(angle));
      EXPECT_DOUBLE_EQ(numbers[i + 1], radius * std::sin(angle));
    }
  }
}

}  // namespace
}  // namespace spikeloop
