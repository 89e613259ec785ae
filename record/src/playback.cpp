#include "spikeloop/record/playback.hpp"

#include <algorithm>

#include "spikeloop/record/reader.hpp"

namespace spikeloop::record {
namespace {

class SpikePlayback : public Source {
 public:
  explicit SpikePlayback(SpikeRecording recording) : recording_(std::move(recording)) {
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
  SpikeRecording recording_;
  std::size_t next_ = 0;
};

class SignalPlayback : public Source {
 public:
  explicit SignalPlayback(SignalRecording recording) : recording_(std::move(recording)) {}
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
  SignalRecording recording_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<ParameterDescription> playback_parameters() {
  return {{.name = "file",
           .type = ParameterType::text,
           .text = "Recording in a run folder, e.g. run1/encoder.h5"},
          {.name = "stream",
           .type = ParameterType::text,
           .default_value = "out",
           .text = "Name of the stream in the file: the recorded port"}};
}

std::unique_ptr<Source> make_spike_playback(const std::string& file, const std::string& stream) {
  return std::make_unique<SpikePlayback>(read_spikes(file, stream));
}

std::unique_ptr<Source> make_signal_playback(const std::string& file, const std::string& stream) {
  return std::make_unique<SignalPlayback>(read_signal(file, stream));
}

}  // namespace spikeloop::record
