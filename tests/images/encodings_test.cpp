// Encodings, each against its definition in sensor_msgs/image_encodings.hpp,
// OpenCV's types and V4L2's formats.
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
using test::Picture;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsNan;

/// Samples in the other byte order.
template <typename T>
std::vector<std::byte> swapped(const std::vector<T>& samples) {
  std::vector<std::byte> bytes = bytes_of(samples);
  for (auto at = bytes.begin(); at != bytes.end(); at += sizeof(T)) {
    std::reverse(at, at + sizeof(T));
  }
  return bytes;
}

/// The image in either byte order, and with four more bytes per row.
template <typename T>
std::vector<Picture> in_all_orders(std::uint32_t width, std::uint32_t height, const char* encoding,
                                   const std::vector<T>& samples) {
  std::vector<Picture> pictures;
  for (const bool big_endian : {false, true}) {
    const auto bytes = big_endian ? swapped(samples) : bytes_of(samples);
    pictures.push_back({width, height, encoding, bytes, 0, big_endian});
    const std::size_t row = bytes.size() / height;
    std::vector<std::byte> padded;
    for (std::size_t y = 0; y < height; ++y) {
      const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(y * row);
      padded.insert(padded.end(), first, first + static_cast<std::ptrdiff_t>(row));
      padded.insert(padded.end(), 4, std::byte{0x5a});
    }
    pictures.push_back(
        {width, height, encoding, padded, static_cast<std::uint32_t>(row + 4), big_endian});
  }
  return pictures;
}

/// Two pixels of red, green and blue 200, 100, 50 and 10, 20, 30 hundredths of white.
template <typename T>
void expect_colours(const char* encoding, double white, const std::vector<T>& samples,
                    std::optional<std::pair<double, double>> range = {}) {
  SCOPED_TRACE(encoding);
  const auto value = [&](double light) { return 2 * light / white - 1; };
  for (const Picture& picture : in_all_orders(2, 1, encoding, samples)) {
    expect_near(converted({.channel = Channel::rgb, .range = range}, picture.view()),
                {value(200), value(10), value(100), value(20), value(50), value(30)}, 1e-6);
    expect_near(converted({.range = range}, picture.view()),
                {value(0.299 * 200 + 0.587 * 100 + 0.114 * 50),
                 value(0.299 * 10 + 0.587 * 20 + 0.114 * 30)},
                1e-6);
  }
}

TEST(Encodings, three_and_four_components_of_opencv_begin_with_blue) {
  expect_colours<std::uint8_t>("8UC3", 255, {50, 100, 200, 30, 20, 10});
  expect_colours<std::uint8_t>("8UC4", 255, {50, 100, 200, 9, 30, 20, 10, 9});
  expect_colours<std::uint16_t>("16UC3", 65535, {50, 100, 200, 30, 20, 10});
  expect_colours<std::uint16_t>("16UC4", 65535, {50, 100, 200, 9, 30, 20, 10, 9});
  const std::pair range(0.0, 300.0);
  expect_colours<std::int16_t>("16SC3", 300, {50, 100, 200, 30, 20, 10}, range);
  expect_colours<std::int32_t>("32SC4", 300, {50, 100, 200, 9, 30, 20, 10, 9}, range);
  expect_colours<float>("32FC3", 300, {50, 100, 200, 30, 20, 10}, range);
  expect_colours<double>("64FC4", 300, {50, 100, 200, 9, 30, 20, 10, 9}, range);
}

TEST(Encodings, eight_and_sixteen_bits_per_colour) {
  expect_colours<std::uint8_t>("rgb8", 255, {200, 100, 50, 10, 20, 30});
  expect_colours<std::uint8_t>("bgr8", 255, {50, 100, 200, 30, 20, 10});
  expect_colours<std::uint8_t>("rgba8", 255, {200, 100, 50, 9, 10, 20, 30, 9});
  expect_colours<std::uint8_t>("bgra8", 255, {50, 100, 200, 9, 30, 20, 10, 9});
  expect_colours<std::uint16_t>("rgb16", 65535, {200, 100, 50, 10, 20, 30});
  expect_colours<std::uint16_t>("bgr16", 65535, {50, 100, 200, 30, 20, 10});
  expect_colours<std::uint16_t>("rgba16", 65535, {200, 100, 50, 9, 10, 20, 30, 9});
  expect_colours<std::uint16_t>("bgra16", 65535, {50, 100, 200, 9, 30, 20, 10, 9});
}

template <typename T>
void expect_numbers(const std::vector<const char*>& encodings) {
  for (const char* encoding : encodings) {
    SCOPED_TRACE(encoding);
    for (const Picture& picture : in_all_orders<T>(3, 1, encoding, {-100, 20, 110})) {
      EXPECT_THAT(converted({.range = std::pair(-100.0, 100.0)}, picture.view()),
                  ElementsAre(-1, DoubleEq(0.2), 1));
      EXPECT_THAT(error_of([&] { converted({}, picture.view()); }),
                  Fault(std::string("C: ... ") + encoding + " ... range: [ ... [SL0504]"));
    }
  }
}

TEST(Encodings, numbers_with_a_sign) {
  expect_numbers<std::int8_t>({"8SC1", "8S"});
  expect_numbers<std::int16_t>({"16SC1", "16S"});
  expect_numbers<std::int32_t>({"32SC1", "32S"});
  expect_numbers<float>({"32FC1", "32F"});
  expect_numbers<double>({"64FC1", "64F"});
  // Each pixel is limited before the mean; 0 is a number.
  const Picture far{4, 1, "32SC1", bytes_of<std::int32_t>({0, 50, 2'000'000'000, 0})};
  EXPECT_THAT(converted({.resize = Size{2, 1}, .range = std::pair(0.0, 100.0)}, far.view()),
              ElementsAre(-0.5, 0));
}

TEST(Encodings, doubles_without_a_reading_and_beyond_float) {
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  const Picture metres{6, 1, "64FC1", bytes_of<double>({1, nan, nan, nan, 1e300, -inf})};
  EXPECT_THAT(converted({.resize = Size{3, 1}, .range = std::pair(0.0, 4.0)}, metres.view()),
              ElementsAre(-0.5, IsNan(), 0));
  EXPECT_EQ(converted({.range = std::pair(0.0, 4.0)}, metres.view())[4], 1);
}

TEST(Encodings, types_without_a_number_of_components_have_one) {
  const Picture grey{2, 1, "8U", bytes_of<std::uint8_t>({0, 255})};
  EXPECT_THAT(converted({}, grey.view()), ElementsAre(-1, 1));
  const Picture depth{2, 1, "16U", bytes_of<std::uint16_t>({0, 1000})};
  EXPECT_THAT(converted({.range = std::pair(0.0, 2000.0)}, depth.view()), ElementsAre(IsNan(), 0));
}

TEST(Encodings, unknown_ones_are_named) {
  for (const char* encoding : {"8UC2", "8UC", "8UC5", "32FC2", "16UC10", "32UC1", "8UC3 ", "RGB8",
                               "", "jpeg", "yuv420", "nv42", "bayer_rggb12", "C3", "128FC1"}) {
    const Picture picture{2, 2, encoding, std::vector<std::byte>(64)};
    EXPECT_THAT(error_of([&] { converted({}, picture.view()); }),
                Fault(std::string("C: images with the encoding '") + encoding + "' ... [SL0511]"));
  }
}

/// A cell has red 200, green 90 and 110, blue 50, in the order of the encoding's name.
template <typename T>
void expect_cells(const std::string& encoding, const std::vector<T>& cell) {
  SCOPED_TRACE(encoding);
  // Odd sizes: the last row and column take the colours of the cell before them.
  std::vector<T> samples;
  for (std::size_t i = 0; i < 15; ++i) {
    samples.push_back(cell[i / 5 % 2 * 2 + i % 5 % 2]);
  }
  for (const Picture& picture : in_all_orders(5, 3, encoding.c_str(), samples)) {
    const auto values =
        converted({.channel = Channel::rgb, .range = std::pair(0.0, 200.0)}, picture.view());
    std::vector<double> expected(45, -0.5);
    std::fill_n(expected.begin(), 15, 1);
    std::fill_n(expected.begin() + 15, 15, 0);
    expect_near(values, expected, 1e-9);
  }
}

TEST(Encodings, bayer_cells) {
  const std::pair<std::string, std::vector<std::uint16_t>> all[] = {
      {"bayer_rggb", {200, 90, 110, 50}},
      {"bayer_bggr", {50, 90, 110, 200}},
      {"bayer_gbrg", {90, 50, 200, 110}},
      {"bayer_grbg", {90, 200, 50, 110}}};
  for (const auto& [encoding, cell] : all) {
    expect_cells(encoding + "16", cell);
    expect_cells(encoding + "8", std::vector<std::uint8_t>(cell.begin(), cell.end()));
  }
}

TEST(Encodings, grey_of_eight_and_sixteen_bits) {
  for (const Picture& picture :
       in_all_orders<std::uint16_t>(2, 2, "mono16", {0x1234, 65535, 0, 1})) {
    EXPECT_THAT(converted({}, picture.view()),
                ElementsAre(DoubleEq(2.0 * 0x1234 / 65535 - 1), 1, -1, DoubleEq(2.0 / 65535 - 1)));
  }
  for (const Picture& picture : in_all_orders<std::uint8_t>(2, 2, "mono8", {0, 255, 255, 0})) {
    EXPECT_THAT(converted({}, picture.view()), ElementsAre(-1, 1, 1, -1));
  }
}

/// A YUV image, and how its planes lie.
struct Planar {
  const char* encoding;
  std::size_t width;
  std::size_t height;
  std::size_t stride;  ///< of luma; 0: rows without gaps
};

struct Yuv {
  double y = 0;
  double u = 0;
  double v = 0;
};

/// BT.601 with samples from 0 to 255 (JFIF).
std::vector<double> rgb_of(const Yuv& c) {
  const auto value = [](double light) {
    return 2 * std::round(std::clamp(light, 0.0, 255.0)) / 255 - 1;
  };
  return {value(c.y + 1.402 * (c.v - 128)),
          value(c.y - 0.344136 * (c.u - 128) - 0.714136 * (c.v - 128)),
          value(c.y + 1.772 * (c.u - 128))};
}

/// Writes luma and chroma as V4L2 defines NV12, NV21 and NV24.
void expect_planar(const Planar& planar) {
  SCOPED_TRACE(testing::Message() << planar.encoding << " " << planar.width << " x "
                                  << planar.height << ", step " << planar.stride);
  std::mt19937 random(5);
  const std::string name = planar.encoding;
  const std::size_t shared = name == "nv24" ? 1 : 2;
  const std::size_t columns = (planar.width + shared - 1) / shared;
  const std::size_t rows = (planar.height + shared - 1) / shared;
  const std::size_t step = planar.stride == 0 ? planar.width : planar.stride;
  const std::size_t chroma_step = planar.stride == 0 ? 2 * columns : 2 / shared * planar.stride;
  std::vector<std::uint8_t> bytes(step * planar.height + chroma_step * rows);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  std::vector<double> expected(3 * planar.width * planar.height);
  std::vector<double> grey;
  for (std::size_t y = 0; y < planar.height; ++y) {
    for (std::size_t x = 0; x < planar.width; ++x) {
      const std::size_t pair = step * planar.height + y / shared * chroma_step + x / shared * 2;
      const bool v_first = name == "nv21";
      const Yuv pixel{static_cast<double>(bytes[y * step + x]),
                      static_cast<double>(bytes[pair + (v_first ? 1 : 0)]),
                      static_cast<double>(bytes[pair + (v_first ? 0 : 1)])};
      const auto rgb = rgb_of(pixel);
      for (std::size_t c = 0; c < 3; ++c) {
        expected[c * planar.width * planar.height + y * planar.width + x] = rgb[c];
      }
      grey.push_back(2 * pixel.y / 255 - 1);
    }
  }
  const Picture picture{static_cast<std::uint32_t>(planar.width),
                        static_cast<std::uint32_t>(planar.height), name, bytes_of(bytes),
                        static_cast<std::uint32_t>(step)};
  expect_near(converted({.channel = Channel::rgb}, picture.view()), expected, 1.01 * 2.0 / 255);
  expect_near(converted({}, picture.view()), grey, 1e-6);
}

TEST(Encodings, planes_of_luma_and_chroma) {
  for (const char* encoding : {"nv12", "nv21", "nv24"}) {
    for (const std::size_t width : {1, 2, 5, 6}) {
      for (const std::size_t height : {1, 2, 3, 4}) {
        expect_planar({encoding, width, height, 0});
        expect_planar({encoding, width, height, 8});
      }
    }
  }
}

TEST(Encodings, planes_whose_step_counts_the_chroma) {
  std::vector<std::uint8_t> bytes(4 * 2, 51);
  bytes.resize(4 * 3, 128);
  for (const std::uint32_t step : {4, 6, 8}) {
    const Picture picture{4, 2, "nv12", bytes_of(bytes), step};
    expect_near(converted({.channel = Channel::rgb}, picture.view()), std::vector<double>(24, -0.6),
                1e-6);
  }
}

TEST(Encodings, planes_that_are_cut_off) {
  for (const auto& [encoding, whole] :
       {std::pair("nv12", std::size_t{8 * 2 + 8}), {"nv21", 8 * 2 + 8}, {"nv24", 8 * 2 + 16 * 2}}) {
    for (std::size_t size = 0; size < whole; ++size) {
      const Picture picture{8, 2, encoding, std::vector<std::byte>(size), 8};
      EXPECT_THAT(error_of([&] { converted({}, picture.view()); }),
                  Fault("T: it has " + std::to_string(size) + " bytes ... [SL0509]"));
    }
  }
  const Picture narrow{8, 2, "nv12", std::vector<std::byte>(24), 4};
  EXPECT_THAT(error_of([&] { converted({}, narrow.view()); }),
              Fault("T: its step is 4 ... [SL0509]"));
}

// Chroma that is far outside of RGB must not change the luma.
TEST(Encodings, the_grey_of_yuv_is_its_luma) {
  const Picture uyvy{2, 1, "uyvy", bytes_of<std::uint8_t>({255, 51, 255, 204})};
  const Picture yuyv{2, 1, "yuyv", bytes_of<std::uint8_t>({51, 255, 204, 255})};
  for (const Picture& picture : {uyvy, yuyv}) {
    expect_near(converted({}, picture.view()), {-0.6, 0.6}, 1e-6);
  }
}

}  // namespace
