// What an event camera costs: bytes of a message to channels, and those to spikes at their times.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "spikeloop/messages/event_array.hpp"
#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/messages/event_playback.hpp"

namespace spikeloop {
namespace {

constexpr std::uint32_t kWidth = 640;
constexpr std::uint32_t kHeight = 480;
constexpr TimeNs kTick = 1'000'000;

template <typename T>
void append(std::vector<std::byte>& bytes, T value) {
  const auto* const data = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), data, data + sizeof(T));
}

/// A message of `count` events at random pixels, spread evenly over a tick.
std::vector<std::byte> message(std::size_t count) {
  std::mt19937 random(1);
  std::vector<std::byte> bytes(12);
  append(bytes, std::uint32_t{0});  // no frame
  append(bytes, kHeight);
  append(bytes, kWidth);
  append(bytes, static_cast<std::uint32_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    append(bytes, static_cast<std::uint16_t>(random() % kWidth));
    append(bytes, static_cast<std::uint16_t>(random() % kHeight));
    append(bytes, std::uint32_t{1000});
    append(bytes,
           static_cast<std::uint32_t>(kTick * static_cast<TimeNs>(i) / static_cast<TimeNs>(count)));
    append(bytes, static_cast<std::uint8_t>(random() % 2));
  }
  return bytes;
}

void parse(benchmark::State& state) {
  const auto bytes = message(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    const messages::EventArray array(bytes, messages::Dialect::ros1);
    TimeNs newest = 0;
    std::uint32_t pixels = 0;
    for (std::size_t i = 0; i < array.size(); ++i) {
      const messages::CameraEvent event = array[i];
      newest = std::max(newest, event.stamp);
      pixels += event.x + event.y * kWidth + (event.on ? 1 : 0);
    }
    benchmark::DoNotOptimize(newest);
    benchmark::DoNotOptimize(pixels);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(parse)->ArgName("events")->Arg(1'000)->Arg(100'000);

void convert(benchmark::State& state, messages::EventSettings settings) {
  const auto bytes = message(static_cast<std::size_t>(state.range(0)));
  messages::EventConversion conversion(settings, messages::Dialect::ros1);
  messages::EventMessage events;
  for (auto _ : state) {
    conversion.convert(bytes, events);
    benchmark::DoNotOptimize(events.events.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK_CAPTURE(convert, whole, {.width = kWidth * kHeight})
    ->ArgName("events")
    ->Arg(1'000)
    ->Arg(100'000);
BENCHMARK_CAPTURE(convert, split_blocks_of_4,
                  {.polarity = messages::Polarity::split, .downsample = 4, .width = 38'400})
    ->ArgName("events")
    ->Arg(100'000);
BENCHMARK_CAPTURE(convert, refractory, {.refractory = 1, .width = kWidth * kHeight})
    ->ArgName("events")
    ->Arg(100'000);

// A message a tick of 1 ms, with 40 ms of events waiting: from bytes to the spikes of the tick.
void play(benchmark::State& state) {
  const auto bytes = message(static_cast<std::size_t>(state.range(0)));
  messages::EventConversion conversion({.width = kWidth * kHeight}, messages::Dialect::ros1);
  messages::EventPlayback playback(40 * kTick);
  TimeNs begin = 0;
  playback.step({}, {begin, begin + kTick});
  for (auto _ : state) {
    begin += kTick;
    messages::EventMessage events;
    conversion.convert(bytes, events);
    for (Spike& event : events.events) {
      event.time_ns += begin;
    }
    *events.newest += begin;
    const auto due = playback.step({&events, 1}, {begin, begin + kTick});
    benchmark::DoNotOptimize(due.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(play)->ArgName("events")->Arg(1'000)->Arg(10'000);

}  // namespace
}  // namespace spikeloop
