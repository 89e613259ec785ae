#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/images/pictures.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::images;
using test::bytes_of;
using test::converted;
using test::expect_near;
using test::grey_picture;
using test::Picture;

/// The definition in two dimensions, which the filter takes one after the other.
double gaussian_average(const std::vector<double>& light, int width, int height, int u, int v,
                        double deviation) {
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  double sum = 0;
  double weights = 0;
  for (int y = std::max(0, v - radius); y <= std::min(height - 1, v + radius); ++y) {
    for (int x = std::max(0, u - radius); x <= std::min(width - 1, u + radius); ++x) {
      const double distance = (x - u) * (x - u) + (y - v) * (y - v);
      const double weight = std::exp(-distance / (2 * deviation * deviation));
      sum += weight * light[static_cast<std::size_t>(y * width + x)];
      weights += weight;
    }
  }
  return sum / weights;
}

TEST(ImageFilter, one_light_everywhere_has_no_contrast) {
  const Picture picture = grey_picture(9, 7, [](int, int) { return 177; });
  expect_near(converted({.filter = Filter::centre_surround}, picture.view()),
              std::vector<double>(63, 0.0), 1e-12);
  expect_near(converted({.filter = Filter::on_off}, picture.view()), std::vector<double>(126, -1.0),
              1e-12);
}

TEST(ImageFilter, is_a_difference_of_two_gaussians) {
  constexpr int kColumns = 13;
  constexpr int kRows = 11;
  std::vector<double> light;
  const Picture picture = grey_picture(kColumns, kRows, [&](int x, int y) {
    light.push_back((37 * x + 91 * y * y) % 256 / 255.0);
    return (37 * x + 91 * y * y) % 256;
  });
  std::vector<double> contrast;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      contrast.push_back(gaussian_average(light, kColumns, kRows, x, y, 0.8) -
                         gaussian_average(light, kColumns, kRows, x, y, 2.1));
    }
  }
  const ImageSettings settings{
      .filter = Filter::centre_surround, .centre = 0.8, .surround = 2.1, .gain = 1.5};
  std::vector<double> expected;
  for (const double value : contrast) {
    expected.push_back(std::clamp(1.5 * value, -1.0, 1.0));
  }
  expect_near(converted(settings, picture.view()), expected, 1e-9);

  ImageSettings halves = settings;
  halves.filter = Filter::on_off;
  std::vector<double> on;
  std::vector<double> off;
  for (const double value : contrast) {
    on.push_back(std::clamp(2 * std::max(0.0, 1.5 * value) - 1, -1.0, 1.0));
    off.push_back(std::clamp(2 * std::max(0.0, -1.5 * value) - 1, -1.0, 1.0));
  }
  on.insert(on.end(), off.begin(), off.end());
  expect_near(converted(halves, picture.view()), on, 1e-9);
}

TEST(ImageFilter, every_colour_has_its_own_planes) {
  // A red point on black: on in red's first plane, nothing in green's and blue's.
  std::vector<std::uint8_t> bytes(3 * 25, 0);
  bytes[3 * 12] = 255;
  const Picture picture{5, 5, "rgb8", bytes_of(bytes)};
  const auto values =
      converted({.channel = Channel::rgb, .filter = Filter::on_off}, picture.view());
  ASSERT_EQ(values.size(), 6u * 25);
  EXPECT_GT(values[12], -0.9);
  EXPECT_EQ(values[25 + 12], -1);
  for (std::size_t i = 50; i < values.size(); ++i) {
    EXPECT_EQ(values[i], -1);
  }
}

TEST(ImageFilter, pixels_without_a_reading_stay_so_and_do_no_harm) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Picture picture{3, 1, "32FC1", bytes_of<float>({2, nan, 2})};
  const auto values =
      converted({.range = std::pair(0.0, 4.0), .filter = Filter::centre_surround}, picture.view());
  EXPECT_NEAR(values[0], 0, 1e-12);
  EXPECT_TRUE(std::isnan(values[1]));
  EXPECT_NEAR(values[2], 0, 1e-12);
}

}  // namespace
