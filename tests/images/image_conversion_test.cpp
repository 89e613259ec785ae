#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/images/pictures.hpp"
#include "tests/support/fault.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::images;
using test::bytes_of;
using test::converted;
using test::error_of;
using test::expect_near;
using test::grey_picture;
using test::Picture;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsNan;

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInf = std::numeric_limits<float>::infinity();

TEST(ImageConversion, black_is_minus_one_and_white_is_one) {
  const Picture picture = grey_picture(3, 1, [](int x, int) {
    return x == 0 ? 0 : x == 1 ? 51 : 255;
  });
  EXPECT_THAT(converted({}, picture.view()), ElementsAre(-1.0, DoubleEq(-0.6), 1.0));
}

TEST(ImageConversion, averages_of_whole_blocks_are_exact) {
  // A checkerboard of single pixels: every block of 2 x 2 has the same light.
  const Picture board =
      grey_picture(8, 6, [](int x, int y) { return (x + y) % 2 == 0 ? 200 : 100; });
  for (const double value : converted({.resize = Size{4, 3}}, board.view())) {
    EXPECT_DOUBLE_EQ(value, 2 * 150.0 / 255 - 1);
  }
  // A ramp: the mean of a block is its middle.
  const Picture ramp = grey_picture(40, 4, [](int x, int y) { return 4 * x + y; });
  const auto values = converted({.resize = Size{10, 1}}, ramp.view());
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_DOUBLE_EQ(values[i], 2 * (16.0 * static_cast<double>(i) + 6 + 1.5) / 255 - 1);
  }
}

/// The definition, word by word: the overlap of each pair of pixels.
std::vector<double> averages(const std::vector<double>& light, int width, int height, Size size) {
  std::vector<double> result;
  const auto overlap = [](double a, double b, int pixel) {
    return std::max(0.0, std::min(b, pixel + 1.0) - std::max(a, static_cast<double>(pixel)));
  };
  const double step_x = static_cast<double>(width) / size.width;
  const double step_y = static_cast<double>(height) / size.height;
  for (std::uint32_t v = 0; v < size.height; ++v) {
    for (std::uint32_t u = 0; u < size.width; ++u) {
      double sum = 0;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          sum += light[static_cast<std::size_t>(y * width + x)] *
                 overlap(u * step_x, (u + 1) * step_x, x) *
                 overlap(v * step_y, (v + 1) * step_y, y);
        }
      }
      result.push_back(2 * sum / (step_x * step_y) / 255 - 1);
    }
  }
  return result;
}

TEST(ImageConversion, averages_of_any_size_are_those_of_the_definition) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 60; ++trial) {
    const int width = 1 + static_cast<int>(random() % 23);
    const int height = 1 + static_cast<int>(random() % 23);
    const Size size{1 + static_cast<std::uint32_t>(random() % 30),
                    1 + static_cast<std::uint32_t>(random() % 30)};
    std::vector<double> light;
    const Picture picture = grey_picture(static_cast<std::uint32_t>(width),
                                         static_cast<std::uint32_t>(height), [&](int, int) {
                                           light.push_back(static_cast<double>(random() % 256));
                                           return static_cast<int>(light.back());
                                         });
    SCOPED_TRACE(testing::Message()
                 << width << " x " << height << " to " << size.width << " x " << size.height);
    expect_near(converted({.resize = size}, picture.view()), averages(light, width, height, size),
                1e-6);
  }
}

TEST(ImageConversion, crop_comes_before_resize) {
  const Picture picture = grey_picture(10, 10, [](int x, int y) { return 10 * y + x; });
  EXPECT_THAT(converted({.crop = Crop{2, 3, 2, 2}, .range = std::pair(0.0, 100.0)}, picture.view()),
              ElementsAre(DoubleEq(-0.36), DoubleEq(-0.34), DoubleEq(-0.16), DoubleEq(-0.14)));
  EXPECT_THAT(
      converted({.crop = Crop{2, 3, 2, 2}, .resize = Size{1, 1}, .range = std::pair(0.0, 100.0)},
                picture.view()),
      ElementsAre(DoubleEq(-0.25)));
  EXPECT_EQ(
      error_of([&] {
        converted({.crop = Crop{2, 3, 9, 2}}, picture.view());
      }),
      "C: crop: [2, 3, 9, 2] reaches beyond the image, which has 10 x 10 pixels; write a part "
      "within it [SL0203]");
}

TEST(ImageConversion, range_limits) {
  const Picture picture = grey_picture(4, 1, [](int x, int) { return 50 * x; });
  EXPECT_THAT(converted({.range = std::pair(50.0, 100.0)}, picture.view()),
              ElementsAre(-1.0, -1.0, 1.0, 1.0));
}

TEST(ImageConversion, log_intensity) {
  const Picture picture = grey_picture(3, 1, [](int x, int) {
    return x == 0 ? 0 : x == 1 ? 51 : 255;
  });
  EXPECT_THAT(converted({.intensity = Intensity::log}, picture.view()),
              ElementsAre(-1.0, DoubleEq(2 * std::log(21.0) / std::log(101.0) - 1), 1.0));
}

TEST(ImageConversion, one_colour) {
  const Picture picture{1, 1, "bgr8", bytes_of<std::uint8_t>({51, 102, 204})};
  const std::pair<Channel, double> all[] = {
      {Channel::red, 0.6}, {Channel::green, -0.2}, {Channel::blue, -0.6}};
  for (const auto& [channel, value] : all) {
    EXPECT_THAT(converted({.channel = channel}, picture.view()), ElementsAre(DoubleEq(value)));
  }
}

TEST(ImageConversion, grey_pictures_have_their_light_in_all_colours) {
  const Picture picture = grey_picture(2, 1, [](int x, int) { return 255 * x; });
  EXPECT_THAT(converted({.channel = Channel::blue}, picture.view()), ElementsAre(-1.0, 1.0));
  EXPECT_EQ(converted({.channel = Channel::rgb}, picture.view()).size(), 6u);
}

// Y, U, V of saturated red in BT.601: 76.2, 85, 255.5; both pixels of a pair share U and V.
TEST(ImageConversion, pairs_of_pixels) {
  const Picture uyvy{2, 1, "yuv422", bytes_of<std::uint8_t>({85, 76, 255, 76})};
  const Picture yuyv{2, 1, "yuv422_yuy2", bytes_of<std::uint8_t>({76, 85, 76, 255})};
  for (const Picture& picture : {uyvy, yuyv}) {
    expect_near(
        converted({.channel = Channel::red, .range = std::pair(0.0, 255.0)}, picture.view()),
        {1, 1}, 0.01);
    expect_near(converted({.channel = Channel::green}, picture.view()), {-1, -1}, 0.01);
    expect_near(converted({.channel = Channel::blue}, picture.view()), {-1, -1}, 0.01);
  }
  // Without colour, luma is the grey.
  const Picture plain{2, 1, "uyvy", bytes_of<std::uint8_t>({128, 0, 128, 255})};
  expect_near(converted({}, plain.view()), {-1, 1}, 1e-6);
}

TEST(ImageConversion, depths_without_a_reading_are_left_out) {
  const Picture metres{4, 2, "32FC1", bytes_of<float>({1, kNan, kNan, kInf, 3, kNan, kNan, -kInf})};
  const ImageSettings settings{.resize = Size{2, 1}, .range = std::pair(0.0, 4.0)};
  // One and three metres; no reading in the upper right; limits before the mean.
  EXPECT_THAT(converted(settings, metres.view()), ElementsAre(0.0, 0.0));
  const Picture nothing{2, 1, "32FC1", bytes_of<float>({kNan, 2})};
  EXPECT_THAT(converted({.range = std::pair(0.0, 4.0)}, nothing.view()), ElementsAre(IsNan(), 0.0));
  const Picture millimetres{4, 1, "16UC1", bytes_of<std::uint16_t>({1000, 0, 0, 0})};
  EXPECT_THAT(
      converted({.resize = Size{2, 1}, .range = std::pair(0.0, 4000.0)}, millimetres.view()),
      ElementsAre(-0.5, IsNan()));
  EXPECT_EQ(error_of([&] { converted({}, metres.view()); }),
            "C: images with the encoding 32FC1 have no range of their own; write the values that "
            "become -1 and 1, as in  image: {range: [0.3, 5]} [SL0504]");
  EXPECT_THAT(
      error_of([&] { converted({}, millimetres.view()); }),
      Fault("C: images ... 16UC1 ... -1 and 1, as in  image: {range: [300, 5000]} ... [SL0504]"));
}

TEST(ImageConversion, a_smaller_picture_after_a_larger_one) {
  ImageConversion conversion({});
  const Picture large = grey_picture(9, 9, [](int, int) { return 255; });
  const Picture small = grey_picture(2, 1, [](int, int) { return 0; });
  EXPECT_EQ(conversion.convert(large.view()).size(), 81u);
  EXPECT_THAT(conversion.convert(small.view()), ElementsAre(-1.0, -1.0));
  EXPECT_EQ(conversion.size().width, 2u);
}

TEST(ImageConversion, what_is_wrong_is_said) {
  const auto text = [](std::uint32_t width, std::uint32_t height, std::uint32_t step,
                       std::string_view encoding, std::size_t size = 0) {
    const std::vector<std::byte> bytes(size);
    return error_of([&] { converted({}, {width, height, step, encoding, false, bytes}); });
  };
  EXPECT_EQ(text(2, 2, 2, "mono", 4),
            "C: images with the encoding 'mono' cannot be read; publish them as mono8, rgb8, bgr8, "
            "16UC1 or 32FC1 (docs/images.md lists all encodings) [SL0511]");
  EXPECT_EQ(text(0, 2, 2, "mono8", 4),
            "T: it has 0 x 2 pixels; 1 to 33554432 in all can be used [SL0509]");
  EXPECT_THAT(text(4'000'000'000U, 4'000'000'000U, 2, "mono8", 4),
              Fault("T: it has 4000000000 x 4000000000 pixels; 1 to 33554432 ... [SL0509]"));
  EXPECT_EQ(text(2, 2, 5, "rgb8", 40),
            "T: its step is 5 bytes, but a row of 2 pixels with the encoding rgb8 has 6; correct "
            "'step' [SL0509]");
  EXPECT_EQ(text(2, 2, 2, "mono8", 3),
            "T: it has 3 bytes; 2 x 2 pixels with the encoding mono8 and a step of 2 have 4 "
            "[SL0509]");
  EXPECT_EQ(text(3, 1, 6, "yuyv", 6),
            "T: 3 x 1 pixels cannot be encoded as yuyv; its pixels come in pairs [SL0509]");
  EXPECT_THAT(text(2, 1, 2, "bayer_rggb8", 2),
              Fault("T: 2 x 1 pixels ... bayer_rggb8 ... 2 x 2 [SL0509]"));
  EXPECT_EQ(text(5000, 1, 5000, "mono8", 5000),
            "C: a picture of 5000 x 1 pixels is too large to take every one; write  resize: [40, "
            "30] [SL0203]");
}

}  // namespace
