// exp and log of vectors, written once for all instruction sets: the same additions,
// multiplications and fused multiply-adds in the same order everywhere, so that results agree to
// the last bit. Highway's own functions do not fuse on targets without FMA.
#if defined(SPIKELOOP_NODES_VECTOR_MATH_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SPIKELOOP_NODES_VECTOR_MATH_INL_HPP
#undef SPIKELOOP_NODES_VECTOR_MATH_INL_HPP
#else
#define SPIKELOOP_NODES_VECTOR_MATH_INL_HPP
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace spikeloop::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// a * b + c with one rounding.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V fused(D d, V a, V b, V c) {
#if HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR
  alignas(64) double x[HWY_MAX_BYTES / sizeof(double)];
  alignas(64) double y[HWY_MAX_BYTES / sizeof(double)];
  alignas(64) double z[HWY_MAX_BYTES / sizeof(double)];
  hn::Store(a, d, x);
  hn::Store(b, d, y);
  hn::Store(c, d, z);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    x[i] = std::fma(x[i], y[i], z[i]);
  }
  return hn::Load(d, x);
#else
  static_cast<void>(d);
  return hn::MulAdd(a, b, c);
#endif
}

/// Horner's scheme, the highest power's coefficient first.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V polynomial(D d, V x, const double* coefficients, std::size_t count) {
  V sum = hn::Set(d, coefficients[0]);
  for (std::size_t k = 1; k < count; ++k) {
    sum = fused(d, sum, x, hn::Set(d, coefficients[k]));
  }
  return sum;
}

inline constexpr double kLn2High = 0x1.62e42fefa3800p-1;  // its last 11 bits are 0
inline constexpr double kLn2Low = 0x1.ef35793c76730p-45;

/// e^x to 1 unit in the last place for |x| < 700; beyond that, e^-700 and e^700.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V exponential(D d, V x) {
  // 1 / k!, down from k = 13: enough for |r| <= ln(2) / 2.
  static constexpr double kTaylor[] = {1.0 / 6227020800,
                                       1.0 / 479001600,
                                       1.0 / 39916800,
                                       1.0 / 3628800,
                                       1.0 / 362880,
                                       1.0 / 40320,
                                       1.0 / 5040,
                                       1.0 / 720,
                                       1.0 / 120,
                                       1.0 / 24,
                                       1.0 / 6,
                                       1.0 / 2,
                                       1.0,
                                       1.0};
  constexpr double kLog2E = 0x1.71547652b82fep0;
  const hn::RebindToUnsigned<D> bits;
  x = hn::Min(hn::Max(x, hn::Set(d, -700.0)), hn::Set(d, 700.0));
  const V n = hn::Round(hn::Mul(x, hn::Set(d, kLog2E)));
  V r = fused(d, n, hn::Set(d, -kLn2High), x);
  r = fused(d, n, hn::Set(d, -kLn2Low), r);
  const V e_r = polynomial(d, r, kTaylor, sizeof kTaylor / sizeof *kTaylor);
  // The low bits of 1.5 * 2^52 + m are those of the whole number m.
  const V shifted = hn::Add(n, hn::Set(d, 0x1.8p52 + 1023));
  const V power = hn::BitCast(d, hn::ShiftLeft<52>(hn::BitCast(bits, shifted)));
  return hn::Mul(e_r, power);
}

/// ln x to 2 units in the last place for normal x > 0.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V logarithm(D d, V x) {
  // ln m = 2 (s + s^3 / 3 + s^5 / 5 + ...) with s = (m - 1) / (m + 1), |s| < 0.172.
  static constexpr double kSeries[] = {2.0 / 23, 2.0 / 21, 2.0 / 19, 2.0 / 17, 2.0 / 15, 2.0 / 13,
                                       2.0 / 11, 2.0 / 9,  2.0 / 7,  2.0 / 5,  2.0 / 3};
  const hn::RebindToUnsigned<D> bits;
  const auto raw = hn::BitCast(bits, x);
  const V one = hn::Set(d, 1.0);
  // The exponent as a number: its bits are the low ones of 2^52 + exponent.
  V e = hn::Sub(hn::BitCast(d, hn::Or(hn::ShiftRight<52>(raw),
                                      hn::Set(bits, std::uint64_t{0x4330000000000000}))),
                hn::Set(d, 0x1p52 + 1023));
  V m = hn::BitCast(d, hn::Or(hn::And(raw, hn::Set(bits, std::uint64_t{0x000fffffffffffff})),
                              hn::Set(bits, std::uint64_t{0x3ff0000000000000})));
  const auto high = hn::Gt(m, hn::Set(d, 0x1.6a09e667f3bcdp0));
  m = hn::IfThenElse(high, hn::Mul(m, hn::Set(d, 0.5)), m);
  e = hn::IfThenElse(high, hn::Add(e, one), e);
  const V s = hn::Div(hn::Sub(m, one), hn::Add(m, one));
  const V squared = hn::Mul(s, s);
  const V rest = hn::Mul(polynomial(d, squared, kSeries, sizeof kSeries / sizeof *kSeries),
                         hn::Mul(squared, s));
  const V ln_m = hn::Add(hn::Add(s, s), fused(d, e, hn::Set(d, kLn2Low), rest));
  return fused(d, e, hn::Set(d, kLn2High), ln_m);
}

}  // namespace spikeloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
