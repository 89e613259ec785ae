// Pictures of a camera as channels: what a picture costs, and what part of a core 30 of them a
// second are.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <cstdio>  // jpeglib.h needs it
#include <cstdlib>
#include <string>
#include <vector>

#include <jpeglib.h>

#include "spikeloop/images/image_conversion.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"

namespace {

using namespace spikeloop::images;

constexpr std::uint32_t kWidth = 640;
constexpr std::uint32_t kHeight = 480;
constexpr double kPicturesASecond = 30;

/// A scene with edges and fine structure.
std::vector<std::byte> scene(std::uint32_t bytes_a_pixel) {
  std::vector<std::byte> bytes;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      for (std::uint32_t c = 0; c < bytes_a_pixel; ++c) {
        const std::uint32_t block = (x / 80 + y / 60) % 2 * 100;
        bytes.push_back(static_cast<std::byte>(block + x / 8 + (x * y + 7 * c) % 23 + 20 * c));
      }
    }
  }
  return bytes;
}

std::vector<std::byte> jpeg(std::vector<std::byte> rgb) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &buffer, &size);
  info.image_width = kWidth;
  info.image_height = kHeight;
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 80, TRUE);
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < kHeight) {
    auto* row = reinterpret_cast<JSAMPROW>(rgb.data()) + info.next_scanline * kWidth * 3;
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  const auto* first = reinterpret_cast<const std::byte*>(buffer);
  std::vector<std::byte> file(first, first + size);
  std::free(buffer);
  return file;
}

/// `percent_of_a_core`: of 30 pictures a second, by the processor's time.
void count_share(benchmark::State& state) {
  state.counters["percent_of_a_core"] =
      benchmark::Counter(static_cast<double>(state.iterations()) / kPicturesASecond / 100,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void raw(benchmark::State& state, const std::string& encoding, std::uint32_t bytes_a_pixel,
         const ImageSettings& settings) {
  const std::vector<std::byte> bytes = scene(bytes_a_pixel);
  ImageConversion conversion(settings);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        conversion.convert({kWidth, kHeight, kWidth * bytes_a_pixel, encoding, false, bytes}));
  }
  count_share(state);
}

void compressed(benchmark::State& state, const ImageSettings& settings) {
  const std::vector<std::byte> file = jpeg(scene(3));
  ImageConversion conversion(settings);
  for (auto _ : state) {
    benchmark::DoNotOptimize(conversion.convert_compressed(file));
  }
  count_share(state);
}

/// From the bytes of a message to the channels of a port.
void message(benchmark::State& state, spikeloop::messages::Dialect dialect,
             const ImageSettings& settings) {
  using namespace spikeloop::messages;
  const auto& catalog = Catalog::builtin(dialect);
  const std::vector<double> sizes[] = {{kWidth}, {kHeight}, {3 * kWidth}};
  std::vector<double> data;
  for (const std::byte byte : scene(3)) {
    data.push_back(std::to_integer<int>(byte));
  }
  std::vector<std::byte> bytes;
  MessageWriter(catalog, "sensor_msgs/Image", {"width", "height", "step", "data", "encoding"})
      .write(
          std::vector<FieldValue>{
              {sizes[0], {}}, {sizes[1], {}}, {sizes[2], {}}, {data, {}}, {{}, "rgb8"}},
          bytes);
  SensorConversion conversion(catalog, "sensor_msgs/Image", {.image = settings},
                              settings.values().value_or(0), true);
  for (auto _ : state) {
    benchmark::DoNotOptimize(conversion.convert(bytes));
  }
  count_share(state);
}

const ImageSettings kGrey{.resize = Size{40, 30}};
const ImageSettings kColours{.resize = Size{40, 30}, .channel = Channel::rgb};
const ImageSettings kOnOff{.resize = Size{40, 30}, .filter = Filter::on_off};
const ImageSettings kDepth{.resize = Size{40, 30}, .range = std::pair(0.3, 5.0)};
const ImageSettings kUneven{.resize = Size{41, 31}};

BENCHMARK_CAPTURE(message, ros1_rgb8_to_40x30_grey, spikeloop::messages::Dialect::ros1, kGrey);
BENCHMARK_CAPTURE(message, ros2_rgb8_to_40x30_grey, spikeloop::messages::Dialect::ros2, kGrey);
BENCHMARK_CAPTURE(raw, rgb8_to_40x30_grey, "rgb8", 3, kGrey);
BENCHMARK_CAPTURE(raw, rgb8_to_41x31_grey, "rgb8", 3, kUneven);
BENCHMARK_CAPTURE(raw, rgb8_to_40x30_rgb, "rgb8", 3, kColours);
BENCHMARK_CAPTURE(raw, rgb8_to_40x30_on_off, "rgb8", 3, kOnOff);
BENCHMARK_CAPTURE(raw, mono8_to_40x30_grey, "mono8", 1, kGrey);
BENCHMARK_CAPTURE(raw, yuyv_to_40x30_grey, "yuyv", 2, kGrey);
BENCHMARK_CAPTURE(raw, bayer_to_40x30_grey, "bayer_rggb8", 1, kGrey);
BENCHMARK_CAPTURE(raw, depth_to_40x30, "32FC1", 4, kDepth);
BENCHMARK_CAPTURE(compressed, jpeg_to_40x30_grey, kGrey);
BENCHMARK_CAPTURE(compressed, jpeg_to_40x30_rgb, kColours);

}  // namespace
