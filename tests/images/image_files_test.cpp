// Pictures in files, made here by libjpeg and libpng.
#include <gmock/gmock.h>
#include <png.h>
#include <zlib.h>

#include <cmath>
#include <random>

#include "tests/images/jpeg_file.hpp"
#include "tests/images/pictures.hpp"
#include "tests/support/fault.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::images;
using test::error_of;
using test::expect_near;
using test::Picture;
using testing::HasSubstr;

constexpr int kWidth = 24;
constexpr int kHeight = 18;

/// Smooth, so that JPEG keeps it nearly as it is. rgb: three bytes a pixel, else one.
std::vector<std::uint8_t> smooth(int components) {
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < components; ++c) {
        bytes.push_back(static_cast<std::uint8_t>(20 + 7 * x + (c == 1 ? -5 * x : 3 * y) + 15 * c));
      }
    }
  }
  return bytes;
}

Picture picture_of(const std::string& encoding, const std::vector<std::uint8_t>& bytes) {
  return {kWidth, kHeight, encoding, test::bytes_of(bytes)};
}

std::vector<std::byte> jpeg(const std::vector<std::uint8_t>& bytes, J_COLOR_SPACE in,
                            J_COLOR_SPACE file, bool progressive = false) {
  return test::jpeg_file(bytes, kWidth, kHeight, {in, file, 98, false, progressive});
}

/// @param bytes rows as PNG has them
std::vector<std::byte> png(const std::vector<std::uint8_t>& bytes, int colour_type, int depth,
                           bool interlaced = false) {
  std::vector<std::byte> result;
  png_structp file = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(file);
  png_set_write_fn(
      file, &result,
      [](png_structp to, png_bytep data, std::size_t count) {
        auto& all = *static_cast<std::vector<std::byte>*>(png_get_io_ptr(to));
        const auto* first = reinterpret_cast<const std::byte*>(data);
        all.insert(all.end(), first, first + count);
      },
      nullptr);
  png_set_IHDR(file, info, kWidth, kHeight, depth, colour_type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (colour_type == PNG_COLOR_TYPE_PALETTE) {
    png_color palette[256];
    for (int i = 0; i < 256; ++i) {
      palette[i] = {static_cast<png_byte>(i), static_cast<png_byte>(255 - i), 7};
    }
    png_set_PLTE(file, info, palette, 256);
  }
  png_write_info(file, info);
  std::vector<png_bytep> rows;
  for (std::size_t y = 0; y < kHeight; ++y) {
    rows.push_back(const_cast<png_bytep>(bytes.data()) + y * bytes.size() / kHeight);
  }
  png_write_image(file, rows.data());
  png_write_end(file, nullptr);
  png_destroy_write_struct(&file, &info);
  return result;
}

std::vector<double> converted_file(const ImageSettings& settings,
                                   const std::vector<std::byte>& file,
                                   std::string_view format = {}) {
  ImageConversion conversion(settings);
  const auto values = conversion.convert_compressed(file, format);
  return {values.begin(), values.end()};
}

/// The grey and each colour of a file are those of the raw picture.
void expect_same(const std::vector<std::byte>& file, const Picture& raw, double tolerance,
                 std::string_view format = {},
                 std::optional<std::pair<double, double>> range = {}) {
  for (const Channel channel : {Channel::grey, Channel::red, Channel::rgb}) {
    const ImageSettings settings{.resize = Size{6, 3}, .channel = channel, .range = range};
    expect_near(converted_file(settings, file, format), test::converted(settings, raw.view()),
                tolerance);
  }
}

constexpr double kThreeSteps = 3 * 2.0 / 255;

TEST(ImageFiles, jpeg) {
  expect_same(jpeg(smooth(1), JCS_GRAYSCALE, JCS_GRAYSCALE), picture_of("mono8", smooth(1)),
              kThreeSteps);
  expect_same(jpeg(smooth(3), JCS_RGB, JCS_YCbCr), picture_of("rgb8", smooth(3)), kThreeSteps);
  expect_same(jpeg(smooth(3), JCS_RGB, JCS_YCbCr, true), picture_of("rgb8", smooth(3)),
              kThreeSteps);
  expect_same(jpeg(smooth(3), JCS_RGB, JCS_RGB), picture_of("rgb8", smooth(3)), kThreeSteps);
}

TEST(ImageFiles, png) {
  for (const bool interlaced : {false, true}) {
    expect_same(png(smooth(1), PNG_COLOR_TYPE_GRAY, 8, interlaced), picture_of("mono8", smooth(1)),
                1e-12);
    expect_same(png(smooth(3), PNG_COLOR_TYPE_RGB, 8, interlaced), picture_of("rgb8", smooth(3)),
                1e-12);
    expect_same(png(smooth(4), PNG_COLOR_TYPE_RGBA, 8, interlaced), picture_of("rgba8", smooth(4)),
                1e-12);
  }
}

TEST(ImageFiles, png_of_sixteen_bits) {
  Picture raw = picture_of("16UC1", smooth(2));
  raw.big_endian = true;  // as in PNG
  const auto grey = png(smooth(2), PNG_COLOR_TYPE_GRAY, 16);
  const std::pair range(8'000.0, 30'000.0);
  for (const char* format : {"16UC1; png compressed ", "16UC1; png compressed", "png", ""}) {
    SCOPED_TRACE(format);
    expect_same(grey, raw, 1e-9, format, range);
    EXPECT_THAT(error_of([&] { converted_file({}, grey, format); }),
                Fault("C: images ... 16UC1 ... range: [300, 5000]} [SL0504]"));
  }
  raw.encoding = "mono16";
  expect_same(grey, raw, 1e-9, "mono16; png compressed ");
  raw.encoding = "bayer_grbg16";
  expect_same(grey, raw, 1e-9, "bayer_grbg16; png compressed ");
  Picture colours = picture_of("rgb16", smooth(6));
  colours.big_endian = true;
  expect_same(png(smooth(6), PNG_COLOR_TYPE_RGB, 16), colours, 1e-9, "bgr16; png compressed bgr16");
}

TEST(ImageFiles, grey_files_of_a_bayer_encoding) {
  const Picture raw = picture_of("bayer_gbrg8", smooth(1));
  expect_same(png(smooth(1), PNG_COLOR_TYPE_GRAY, 8), raw, 1e-12, "bayer_gbrg8; png compressed ");
  expect_same(jpeg(smooth(1), JCS_GRAYSCALE, JCS_GRAYSCALE), raw, 2 * kThreeSteps,
              "bayer_gbrg8; jpeg compressed mono8");
  // Converted to colours before the compression.
  expect_same(jpeg(smooth(3), JCS_RGB, JCS_YCbCr), picture_of("rgb8", smooth(3)), kThreeSteps,
              "bayer_gbrg8; jpeg compressed bgr8");
}

TEST(ImageFiles, png_with_a_palette_or_single_bits) {
  std::vector<std::uint8_t> colours;
  for (const std::uint8_t index : smooth(1)) {
    colours.insert(colours.end(), {index, static_cast<std::uint8_t>(255 - index), 7});
  }
  expect_same(png(smooth(1), PNG_COLOR_TYPE_PALETTE, 8), picture_of("rgb8", colours), 1e-12);
  std::vector<std::uint8_t> bits(kWidth / 8 * kHeight, 0xa5);
  std::vector<std::uint8_t> black_and_white;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    black_and_white.push_back((0xa5 >> (7 - i % 8) & 1) != 0 ? 255 : 0);
  }
  expect_same(png(bits, PNG_COLOR_TYPE_GRAY, 1), picture_of("mono8", black_and_white), 1e-12);
}

TEST(ImageFiles, cut_off_anywhere_they_are_refused) {
  for (const auto& file :
       {jpeg(smooth(3), JCS_RGB, JCS_YCbCr), jpeg(smooth(3), JCS_RGB, JCS_YCbCr, true),
        png(smooth(3), PNG_COLOR_TYPE_RGB, 8, true)}) {
    ImageConversion conversion({});
    for (std::size_t size = 0; size < file.size(); ++size) {
      // A JPEG without its last marker has all of its pixels.
      const bool only_marker = file[0] == std::byte{0xff} && size + 2 >= file.size();
      const std::vector<std::byte> part(file.begin(),
                                        file.begin() + static_cast<std::ptrdiff_t>(size));
      if (!only_marker) {
        ASSERT_THAT(error_of([&] { conversion.convert_compressed(part, "jpeg or png"); }),
                    HasSubstr(size == 0 ? "T: it has no data" : "T: its "))
            << size << " of " << file.size() << " bytes";
      }
    }
    EXPECT_EQ(conversion.convert_compressed(file).size(), std::size_t{kWidth} * kHeight);
  }
}

TEST(ImageFiles, damaged_they_are_decoded_or_refused) {
  std::mt19937 random(11);
  for (const auto& file :
       {jpeg(smooth(3), JCS_RGB, JCS_YCbCr), jpeg(smooth(3), JCS_RGB, JCS_YCbCr, true),
        png(smooth(1), PNG_COLOR_TYPE_PALETTE, 8)}) {
    int refused = 0;
    ImageConversion conversion({.channel = Channel::rgb});
    for (int trial = 0; trial < 1'000; ++trial) {
      auto damaged = file;
      for (int i = 0; i < 1 + trial % 4; ++i) {
        damaged[random() % damaged.size()] = static_cast<std::byte>(random());
      }
      const std::string error = error_of([&] { conversion.convert_compressed(damaged); });
      refused += error == "no error" ? 0 : 1;
    }
    EXPECT_GT(refused, 100);
  }
}

TEST(ImageFiles, what_claims_to_be_huge_is_refused) {
  auto bomb = png(smooth(1), PNG_COLOR_TYPE_GRAY, 8);
  // Width and height stand at byte 16, and a check sum behind the header.
  for (const std::size_t at : {std::size_t{16}, std::size_t{20}}) {
    bomb[at] = std::byte{0};
    bomb[at + 1] = std::byte{1};
  }
  const uLong sum = crc32(0, reinterpret_cast<const Bytef*>(bomb.data()) + 12, 17);
  for (int i = 0; i < 4; ++i) {
    bomb[29 + static_cast<std::size_t>(i)] = static_cast<std::byte>(sum >> (24 - 8 * i));
  }
  EXPECT_THAT(error_of([&] { converted_file({}, bomb); }),
              Fault("T: its PNG has 65560 x 65554 pixels; 1 to 33554432 ... [SL0509]"));

  auto picture = jpeg(smooth(1), JCS_GRAYSCALE, JCS_GRAYSCALE);
  const std::byte frame[] = {std::byte{0xff}, std::byte{0xc0}};
  const auto found =
      std::search(picture.begin(), picture.end(), std::begin(frame), std::end(frame));
  ASSERT_NE(found, picture.end());
  std::fill_n(found + 5, 4, std::byte{0xf0});
  EXPECT_THAT(error_of([&] { converted_file({}, picture); }),
              Fault("T: its JPEG has 61680 x 61680 pixels; 1 to 33554432 ... [SL0509]"));
}

TEST(ImageFiles, of_another_kind_are_refused) {
  EXPECT_EQ(error_of([] { converted_file({}, std::vector<std::byte>(9), "jpeg"); }),
            "T: its 9 bytes begin neither as a JPEG nor as a PNG; its format is 'jpeg' [SL0509]");
  EXPECT_EQ(
      error_of([] { converted_file({}, {}, "16UC1; jpeg compressed mono8"); }),
      "T: it has no data, its format is '16UC1; jpeg compressed mono8'; image_transport sends "
      "this if it cannot compress the image, such as distances as JPEG [SL0509]");
  EXPECT_EQ(error_of([] { converted_file({}, jpeg(smooth(4), JCS_CMYK, JCS_CMYK)); }),
            "C: JPEG files with CMYK colours cannot be read; publish JPEG with grey, YCbCr or RGB "
            "[SL0511]");
  EXPECT_THAT(error_of([] { converted_file({}, jpeg(smooth(4), JCS_CMYK, JCS_YCCK)); }),
              Fault("C: JPEG ... CMYK ... [SL0511]"));
}

TEST(ImageFiles, formats_that_cannot_be_read_are_named) {
  const auto error = [](std::string_view format, std::string_view data) {
    return error_of(
        [&] { converted_file({}, test::bytes_of(std::vector(data.begin(), data.end())), format); });
  };
  EXPECT_EQ(error("webp", "RIFF....WEBPVP8 "),
            "C: compressed images with the format 'webp' and data in WebP cannot be read; publish "
            "JPEG, PNG or compressedDepth, or the images without compression [SL0511]");
  const std::pair<const char*, std::string> files[] = {{"TIFF", std::string("II*\0....", 8)},
                                                       {"TIFF", std::string("MM\0*....", 8)},
                                                       {"BMP", "BM......"},
                                                       {"GIF", "GIF89a.."},
                                                       {"JPEG 2000", "....jP  "},
                                                       {"AVIF", "....ftypavif"},
                                                       {"H.264", std::string("\0\0\0\1g...", 8)},
                                                       {"H.264", std::string("\0\0\1g....", 8)},
                                                       {"Ogg", "OggS...."}};
  for (const auto& [name, data] : files) {
    EXPECT_THAT(error("rgb8; jpeg compressed bgr8", data),
                Fault(("C: ... jpeg ... " + std::string(name) + " ... [SL0511]").c_str()));
  }
  for (const char* format :
       {"", "h264", "rgb8; theora", "rgb8; tiff compressed ", "rgb8", "16UC1; zstd"}) {
    EXPECT_THAT(error(format, "????????"),
                Fault((std::string("C: ... '") + format + "' ... [SL0511]").c_str()));
  }
  const auto grey = jpeg(smooth(1), JCS_GRAYSCALE, JCS_GRAYSCALE);
  EXPECT_EQ(
      error_of([&] { converted_file({}, grey, "16UC1; jpeg compressed mono8"); }),
      "C: compressed images with the format '16UC1; jpeg compressed mono8' contain mono8, not "
      "16UC1; publish distances as 16UC1 in PNG, or as compressedDepth [SL0511]");
}

}  // namespace
