#include "playback.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/record/reader.hpp"

namespace spikeloop::fused {
namespace {

class SpikePlayback : public Source {
 public:
  explicit SpikePlayback(record::SpikeRecording recording) : recording_(std::move(recording)) {
    std::ranges::sort(recording_.spikes, spike_before);
  }
  std::vector<EndpointPort> ports() const override {
    return {{"out", PortKind::spikes, recording_.width}};
  }
  void receive(const Step& step) override {
    const TimeNs end = step.interval().end;
    const auto& spikes = recording_.spikes;
    const std::size_t begin = next_;
    while (next_ < spikes.size() && spikes[next_].time_ns <= end) {
      ++next_;
    }
    step.spike_output().emit(std::span(spikes).subspan(begin, next_ - begin));
  }

 private:
  record::SpikeRecording recording_;
  std::size_t next_ = 0;
};

class SignalPlayback : public Source {
 public:
  explicit SignalPlayback(record::SignalRecording recording) : recording_(std::move(recording)) {}
  std::vector<EndpointPort> ports() const override {
    return {{"out", PortKind::signal, recording_.width}};
  }
  void receive(const Step& step) override {
    const std::size_t before = next_;
    while (next_ < recording_.times.size() && recording_.times[next_] <= step.interval().end) {
      ++next_;
    }
    if (next_ == before) {
      return;
    }
    const SignalOutput out = step.signal_output();
    std::ranges::copy(recording_.row(next_ - 1), out.values().begin());
    out.commit();
  }

 private:
  record::SignalRecording recording_;
  std::size_t next_ = 0;
};

void check_width(const experiment::Part& part, std::uint32_t recorded, std::uint32_t width) {
  if (recorded != width) {
    throw ConfigurationError(
        part.where,
        fmt::format("node '{}': the recording {} has {} channels, its connection has "
                    "{}; write [{}]",
                    part.name, part.parameters.text("file"), recorded, width, recorded));
  }
}

}  // namespace

std::unique_ptr<Source> make_playback(const experiment::Part& part, std::uint32_t width) {
  const std::string& file = part.parameters.text("file");
  const std::string& stream = part.parameters.text("stream");
  return located_at(part.where, [&]() -> std::unique_ptr<Source> {
    if (part.kind == experiment::kSpikePlayback) {
      auto recording = record::read_spikes(file, stream);
      check_width(part, recording.width, width);
      return std::make_unique<SpikePlayback>(std::move(recording));
    }
    auto recording = record::read_signal(file, stream);
    check_width(part, recording.width, width);
    return std::make_unique<SignalPlayback>(std::move(recording));
  });
}

}  // namespace spikeloop::fused
