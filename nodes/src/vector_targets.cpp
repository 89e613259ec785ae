#include "vector_targets.hpp"

#include <atomic>

namespace spikeloop {
namespace {

/// The parts of HWY_AVX2 and HWY_AVX3 that kernels use.
VectorTarget best_target() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
      __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2")) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")
               ? VectorTarget::avx3
               : VectorTarget::avx2;
  }
#endif
  return VectorTarget::baseline;
}

std::atomic<VectorTarget>& target() {
  static std::atomic<VectorTarget> target{best_target()};
  return target;
}

}  // namespace

VectorTarget vector_target() {
  return target().load(std::memory_order_relaxed);
}

bool choose_vector_target(VectorTarget chosen) {
  if (chosen > best_target()) {
    return false;
  }
  target().store(chosen);
  return true;
}

}  // namespace spikeloop
