// Which instruction sets kernels are compiled for, and which of them this processor runs; included
// before Highway. x86 without fused multiply-add is left to the baseline, which computes it by
// std::fma; ARM's scalable vectors are left to NEON. Highway's own choice, HWY_DYNAMIC_DISPATCH,
// needs its library, which measures the clock for 4 ms whenever a program starts. Its assertions
// need the library, too.
#pragma once

#include <type_traits>

#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#define HWY_IS_DEBUG_BUILD 0

namespace spikeloop {

enum class VectorTarget { baseline, avx2, avx3 };

/// The best one that this processor has, unless a test has chosen another.
VectorTarget vector_target();

/// For tests. @return false: this processor has not got it
bool choose_vector_target(VectorTarget target);

/// @param avx2, avx3: null where the function is not compiled for them
template <class Function>
Function& function_for_target(Function* baseline, std::type_identity_t<Function*> avx2,
                              std::type_identity_t<Function*> avx3) {
  const VectorTarget target = vector_target();
  if (target == VectorTarget::avx3 && avx3 != nullptr) {
    return *avx3;
  }
  return target != VectorTarget::baseline && avx2 != nullptr ? *avx2 : *baseline;
}

}  // namespace spikeloop

/// In `#if HWY_ONCE`: SPIKELOOP_KERNEL(function)(argument, ...).
#define SPIKELOOP_KERNEL(function)                                                            \
  ::spikeloop::function_for_target(&HWY_STATIC_DISPATCH(function), HWY_CHOOSE_AVX2(function), \
                                   HWY_CHOOSE_AVX3(function))
