// How often a test of random cases repeats.
#pragma once

namespace spikeloop::test {

/// All of them, but a sixth under a sanitizer: it looks for other mistakes, ten times as slowly.
constexpr int repetitions(int all) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return all / 6;
#else
  return all;
#endif
}

}  // namespace spikeloop::test
