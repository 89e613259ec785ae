// Pictures of a camera as channels: what a picture costs, and what part of a core 30 of them a
// second are.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/images/image_conversion.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "tests/images/jpeg_file.hpp"

namespace {

using namespace spikeloop::images;

constexpr std::uint32_t kWidth = 640;
constexpr std::uint32_t kHeight = 480;
constexpr double kPicturesASecond = 30;

/// A scene with edges and fine structure.
std::vector<std::uint8_t> scene(std::uint32_t bytes_a_pixel) {
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      for (std::uint32_t c = 0; c < bytes_a_pixel; ++c) {
        const std::uint32_t block = (x / 80 + y / 60) % 2 * 100;
        bytes.push_back(static_cast<std::uint8_t>(block + x / 8 + (x * y + 7 * c) % 23 + 20 * c));
      }
    }
  }
  return bytes;
}

/// `percent_of_a_core`: of 30 pictures a second, by the processor's time.
void count_share(benchmark::State& state) {
  state.counters["percent_of_a_core"] =
      benchmark::Counter(static_cast<double>(state.iterations()) / kPicturesASecond / 100,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void raw(benchmark::State& state, const std::string& encoding, std::uint32_t bytes_a_pixel,
         const ImageSettings& settings) {
  const std::vector<std::uint8_t> bytes = scene(bytes_a_pixel);
  ImageConversion conversion(settings);
  for (auto _ : state) {
    benchmark::DoNotOptimize(conversion.convert({kWidth, kHeight, kWidth * bytes_a_pixel, encoding,
                                                 false, std::as_bytes(std::span(bytes))}));
  }
  count_share(state);
}

void compressed(benchmark::State& state, const ImageSettings& settings) {
  const std::vector<std::byte> file = spikeloop::test::jpeg_file(scene(3), kWidth, kHeight, {});
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
  const std::vector<std::uint8_t> samples = scene(3);
  const std::vector<double> data(samples.begin(), samples.end());
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
