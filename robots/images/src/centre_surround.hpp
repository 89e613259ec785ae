// A difference of two Gaussians.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace spikeloop::images {

/// G(centre) * plane - G(surround) * plane, with Gaussians cut off at 3 standard deviations whose
/// weights within the plane add up to 1: a plane of one value gives 0 everywhere, at its rim too.
/// NaN is left out of the averages and stays NaN.
class CentreSurround {
 public:
  CentreSurround(double centre, double surround);

  /// @param plane rows of `width` values; replaced.
  void filter(std::span<double> plane, std::uint32_t width);

 private:
  std::vector<double> centre_;  ///< weights at distance 0, 1, ...
  std::vector<double> surround_;
  std::vector<double> light_;
  std::vector<double> there_;
  std::vector<double> narrow_;
  std::vector<double> wide_;
};

}  // namespace spikeloop::images
