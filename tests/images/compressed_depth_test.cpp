// compressedDepth, made here as compressed_depth_image_transport (codec.cpp, rvl_codec.cpp) makes
// it.
#include <gmock/gmock.h>
#include <png.h>

#include <cmath>
#include <cstring>
#include <random>

#include "tests/images/pictures.hpp"
#include "tests/support/fault.hpp"

namespace compressed_depth_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::images;
using test::error_of;
using test::expect_near;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsNan;

using Depths = std::vector<std::uint16_t>;
using Bytes = std::vector<std::byte>;

Bytes joined(Bytes first, const Bytes& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

Bytes png_of(std::uint32_t width, const Depths& depths, png_uint_32 format = PNG_FORMAT_GRAY) {
  const auto height = static_cast<std::uint32_t>(depths.size() / width);
  if (format != PNG_FORMAT_GRAY) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = format;
    const std::vector<png_byte> pixels(PNG_IMAGE_SIZE(image), 3);
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    Bytes file(size);
    EXPECT_NE(png_image_write_to_memory(&image, file.data(), &size, 0, pixels.data(), 0, nullptr),
              0);
    file.resize(size);
    return file;
  }
  Bytes file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &file,
      [](png_structp to, png_bytep data, std::size_t count) {
        auto& all = *static_cast<Bytes*>(png_get_io_ptr(to));
        const auto* first = reinterpret_cast<const std::byte*>(data);
        all.insert(all.end(), first, first + count);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  png_set_swap(png);
  for (std::uint32_t y = 0; y < height; ++y) {
    png_write_row(png, reinterpret_cast<png_const_bytep>(depths.data() + y * width));
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return file;
}

/// The encoder of Wilson's paper: runs of zeros, runs of differences, in nibbles.
Bytes rvl_of(std::uint32_t width, const Depths& depths) {
  std::vector<std::uint32_t> words{width, static_cast<std::uint32_t>(depths.size() / width)};
  std::vector<std::uint32_t> nibbles;
  const auto write = [&](std::uint32_t number) {
    do {
      nibbles.push_back((number & 7U) | (number > 7 ? 8U : 0U));
      number >>= 3U;
    } while (number != 0);
  };
  int previous = 0;
  for (std::size_t i = 0; i < depths.size();) {
    std::size_t end = i;
    while (end < depths.size() && depths[end] == 0) {
      ++end;
    }
    write(static_cast<std::uint32_t>(end - i));
    i = end;
    while (end < depths.size() && depths[end] != 0) {
      ++end;
    }
    write(static_cast<std::uint32_t>(end - i));
    for (; i < end; ++i) {
      const int change = depths[i] - previous;
      write(static_cast<std::uint32_t>(change < 0 ? -2 * change - 1 : 2 * change));
      previous = depths[i];
    }
  }
  nibbles.resize((nibbles.size() + 7) / 8 * 8);
  for (std::size_t i = 0; i < nibbles.size(); i += 8) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      word = word << 4U | nibbles[i + k];
    }
    words.push_back(word);
  }
  return test::bytes_of(words);
}

Bytes header(float first = 0, float second = 0) {
  return joined(test::bytes_of<std::int32_t>({0}), test::bytes_of<float>({first, second}));
}

std::vector<double> values_of(const Bytes& data, std::string_view format, double least,
                              double most) {
  ImageConversion conversion({.range = std::pair(least, most)});
  const auto values = conversion.convert_compressed(data, format);
  return {values.begin(), values.end()};
}

TEST(CompressedDepth, millimetres) {
  const Depths depths{1000, 0, 3000, 65535, 1, 2000};
  for (const char* format : {"16UC1; compressedDepth png", "16UC1; compressedDepth", "16UC1",
                             "mono16; compressedDepth png", ""}) {
    SCOPED_TRACE(format);
    EXPECT_THAT(values_of(joined(header(), png_of(3, depths)), format, 0, 4000),
                ElementsAre(-0.5, IsNan(), 0.5, 1, DoubleNear(-0.9995, 1e-6), 0));
  }
  EXPECT_THAT(values_of(joined(header(), rvl_of(3, depths)), "16UC1; compressedDepth rvl", 0, 4000),
              ElementsAre(-0.5, IsNan(), 0.5, 1, DoubleNear(-0.9995, 1e-6), 0));
  // Without the header, as some programs store it.
  EXPECT_THAT(values_of(png_of(3, depths), "16UC1; compressedDepth png", 0, 4000)[2], 0.5);
  ImageConversion conversion({});
  EXPECT_THAT(error_of([&] {
                conversion.convert_compressed(joined(header(), png_of(3, depths)),
                                              "16UC1; compressedDepth png");
              }),
              Fault("C: images ... 16UC1 ... range: [300, 5000]} [SL0504]"));
}

TEST(CompressedDepth, metres_from_quantised_inverse_depth) {
  // codec.cpp: depthQuantA = Z0 (Z0 + 1), depthQuantB = 1 - depthQuantA / depthMax.
  const float z0 = 100;
  const float most = 10;
  const float a = z0 * (z0 + 1);
  const float b = 1 - a / most;
  const std::vector<float> metres{0.5F, 1.25F, 9.5F, std::nanf(""), 12, 3};
  Depths codes;
  for (const float depth : metres) {
    codes.push_back(depth < most ? static_cast<std::uint16_t>(a / depth + b) : 0);
  }
  for (const bool rvl : {false, true}) {
    const Bytes data = joined(header(a, b), rvl ? rvl_of(3, codes) : png_of(3, codes));
    const auto values =
        values_of(data, rvl ? "32FC1; compressedDepth rvl" : "32FC1; compressedDepth png", 0, 10);
    ASSERT_EQ(values.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
      if (i == 3 || i == 4) {
        EXPECT_TRUE(std::isnan(values[i])) << i;  // no reading, and beyond depth_max
      } else {
        EXPECT_NEAR(values[i], metres[i] / 5 - 1, 2e-3) << i;
      }
    }
  }
  EXPECT_THAT(values_of(joined(header(a, b), png_of(3, codes)), "32FC1; compressedDepth", 0, 10)[0],
              DoubleNear(-0.9, 1e-3));
}

TEST(CompressedDepth, rvl_of_random_depths) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    Depths depths;
    std::vector<double> expected;
    for (int i = 0; i < 7 * 5; ++i) {
      depths.push_back(random() % 3 == 0 ? 0 : static_cast<std::uint16_t>(random()));
      expected.push_back(depths.back());
    }
    const auto values =
        values_of(joined(header(), rvl_of(7, depths)), "16UC1; compressedDepth rvl", 0, 65535);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (depths[i] == 0) {
        EXPECT_TRUE(std::isnan(values[i]));
      } else {
        EXPECT_NEAR(values[i], 2 * expected[i] / 65535 - 1, 1e-6);
      }
    }
  }
}

TEST(CompressedDepth, damaged) {
  const Depths depths{1000, 0, 3000, 65535, 1, 2000};
  const auto error = [](const Bytes& data, std::string_view format) {
    return error_of([&] { values_of(data, format, 0, 4); });
  };
  for (const bool rvl : {false, true}) {
    const char* format = rvl ? "16UC1; compressedDepth rvl" : "16UC1; compressedDepth png";
    const Bytes whole = joined(header(), rvl ? rvl_of(3, depths) : png_of(3, depths));
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      ASSERT_THAT(error(part, format), testing::StartsWith("T: it")) << format << ", " << size;
    }
  }
  EXPECT_EQ(error(joined(header(), png_of(3, depths)), "32FC1; compressedDepth png"),
            "T: the depth parameters of its compressedDepth are 0 and 0; the first must be above 0 "
            "[SL0509]");
  EXPECT_EQ(
      error(joined(header(), png_of(3, depths, PNG_FORMAT_RGB)), "16UC1; compressedDepth png"),
      "T: its compressedDepth is a PNG of rgb8; it must have 16 bits of grey [SL0509]");
  EXPECT_THAT(error(joined(header(), Bytes(50)), "16UC1; compressedDepth zstd"),
              Fault("C: ... '16UC1; compressedDepth zstd' ... [SL0511]"));
  const auto words = [](std::vector<std::uint32_t> numbers) {
    return joined(header(), test::bytes_of(numbers));
  };
  EXPECT_THAT(error(words({0, 5, 0}), "16UC1; compressedDepth rvl"),
              Fault("T: its RVL has 0 x 5 pixels; 1 to 33554432 ... [SL0509]"));
  EXPECT_THAT(error(words({70000, 70000, 0}), "16UC1; compressedDepth rvl"),
              Fault("T: its RVL has 70000 x 70000 pixels ... [SL0509]"));
  EXPECT_EQ(error(words({2, 1, 0x07000000}), "16UC1; compressedDepth rvl"),
            "T: its RVL is damaged: it has more pixels than its size [SL0509]");
  EXPECT_EQ(error(words({2, 1, 0xffffffff, 0xffffffff}), "16UC1; compressedDepth rvl"),
            "T: its RVL is damaged: a number is too long [SL0509]");
}

}  // namespace
}  // namespace compressed_depth_test
