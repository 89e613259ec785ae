// Which instruction sets kernels are compiled for; included before Highway. Those without fused
// multiply-add are left to the baseline, which computes it by std::fma.
#pragma once

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
