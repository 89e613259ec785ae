#include "centre_surround.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spikeloop::images {
namespace {

std::vector<double> gaussian(double deviation) {
  std::vector<double> weights;
  const double radius = std::ceil(3 * deviation);
  for (double distance = 0; distance <= radius; ++distance) {
    weights.push_back(std::exp(-0.5 * distance * distance / (deviation * deviation)));
  }
  return weights;
}

/// Sums of `count` values that lie `stride` apart, weighted by their distance.
void blur_line(const double* from, double* to, std::ptrdiff_t count, std::ptrdiff_t stride,
               const std::vector<double>& weights) {
  const auto radius = static_cast<std::ptrdiff_t>(weights.size()) - 1;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    double sum = 0;
    const std::ptrdiff_t last = std::min(count - 1, i + radius);
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - radius); j <= last; ++j) {
      sum += weights[static_cast<std::size_t>(std::abs(i - j))] * from[j * stride];
    }
    to[i * stride] = sum;
  }
}

void blur(const std::vector<double>& from, std::vector<double>& to, std::size_t width,
          const std::vector<double>& weights) {
  const std::size_t height = from.size() / width;
  std::vector<double> rows(from.size());
  to.resize(from.size());
  for (std::size_t y = 0; y < height; ++y) {
    blur_line(from.data() + y * width, rows.data() + y * width, static_cast<std::ptrdiff_t>(width),
              1, weights);
  }
  for (std::size_t x = 0; x < width; ++x) {
    blur_line(rows.data() + x, to.data() + x, static_cast<std::ptrdiff_t>(height),
              static_cast<std::ptrdiff_t>(width), weights);
  }
}

}  // namespace

CentreSurround::CentreSurround(double centre, double surround)
    : centre_(gaussian(centre)), surround_(gaussian(surround)) {}

void CentreSurround::filter(std::span<double> plane, std::uint32_t width) {
  light_.assign(plane.begin(), plane.end());
  there_.assign(plane.size(), 1.0);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    if (std::isnan(plane[i])) {
      light_[i] = there_[i] = 0;
    }
  }
  std::vector<double> weight;
  const auto average = [&](const std::vector<double>& weights, std::vector<double>& result) {
    blur(light_, result, width, weights);
    blur(there_, weight, width, weights);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      result[i] = there_[i] > 0 ? result[i] / weight[i] : std::numeric_limits<double>::quiet_NaN();
    }
  };
  average(centre_, narrow_);
  average(surround_, wide_);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    plane[i] = narrow_[i] - wide_[i];
  }
}

}  // namespace spikeloop::images
