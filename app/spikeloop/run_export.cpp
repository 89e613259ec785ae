#include "run_export.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/live/neural_messages.hpp"

namespace spikeloop::app {
namespace {

constexpr TimeNs kExportPeriod = kNsPerSecond / 50;         // simulated; of one message of spikes
constexpr std::size_t kMostExported = 65'536;               // spikes of one message
constexpr std::uint64_t kLargestDescription = 100'000'000;  // bytes

bag::Channel channel_of(const live::Channel& channel, const std::string& node) {
  return {channel.topic,
          {channel.encoding, channel.schema_name, channel.schema_encoding, channel.schema},
          node};
}

/// Writes what was recorded of one output in (the last call's `until`, `until`].
class ExportedSpikes {
 public:
  ExportedSpikes(bag::Recorder& file, const RecordedSpikes& spikes)
      : file_(file),
        spikes_(spikes.recording.spikes),
        channel_(file.add_channel(channel_of(live::spike_channel(spikes.topic()), spikes.node))) {}

  void write(TimeNs until) {
    for (; next_ < spikes_.size() && spikes_[next_].time_ns <= until; ++next_) {
      times_.push_back(spikes_[next_].time_ns);
      channels_.push_back(static_cast<std::uint32_t>(spikes_[next_].channel));
      if (times_.size() == kMostExported) {
        flush(until);
      }
    }
    if (!times_.empty()) {
      flush(until);
    }
  }

 private:
  void flush(TimeNs time) {
    live::write_spikes(times_, channels_, message_);
    file_.take(channel_, time, message_);
    times_.clear();
    channels_.clear();
  }

  bag::Recorder& file_;
  const std::vector<Spike>& spikes_;
  std::uint32_t channel_;
  std::size_t next_ = 0;
  std::vector<std::int64_t> times_;
  std::vector<std::uint32_t> channels_;
  std::vector<std::byte> message_;
};

class ExportedSignal {
 public:
  ExportedSignal(bag::Recorder& file, const RecordedSignal& signal)
      : file_(file),
        signal_(signal.recording),
        channel_(file.add_channel(channel_of(live::signal_channel(signal.topic()), signal.node))) {}

  void write(TimeNs until) {
    for (; next_ < signal_.times.size() && signal_.times[next_] <= until; ++next_) {
      live::write_signal(signal_.row(next_), message_);
      file_.take(channel_, signal_.times[next_], message_);
    }
  }

 private:
  bag::Recorder& file_;
  const record::SignalRecording& signal_;
  std::uint32_t channel_;
  std::size_t next_ = 0;
  std::vector<std::byte> message_;
};

class ExportedTopic {
 public:
  ExportedTopic(bag::Recorder& file, const bag::Reader& messages, const bag::Connection& connection)
      : file_(file),
        stream_(messages.stream(connection.topic, connection.node)),
        channel_(file.add_channel({connection.topic, connection.schema, connection.node})) {}

  void write(TimeNs until) {
    while ((waiting_ || (waiting_ = stream_.next())) && waiting_->time <= until) {
      file_.take(channel_, waiting_->time, waiting_->bytes);
      waiting_.reset();
    }
  }

 private:
  bag::Recorder& file_;
  bag::Stream stream_;
  std::uint32_t channel_;
  std::optional<bag::Message> waiting_{};
};

bool write_all(const RunRecordings& run, bag::Recorder& file,
               const std::function<bool(TimeNs)>& progress) {
  std::vector<ExportedSpikes> spikes;
  std::vector<ExportedSignal> signals;
  std::vector<ExportedTopic> topics;
  for (const RecordedSpikes& each : run.spikes) {
    spikes.emplace_back(file, each);
  }
  for (const RecordedSignal& each : run.signals) {
    signals.emplace_back(file, each);
  }
  if (run.messages) {
    for (const bag::Connection& connection : run.messages->connections()) {
      topics.emplace_back(file, *run.messages, connection);
    }
  }
  TimeNs until = 0;
  const auto write = [&](auto& exported) { exported.write(until); };
  do {
    until = std::min(run.end, until + kExportPeriod);
    std::ranges::for_each(spikes, write);
    std::ranges::for_each(signals, write);
    std::ranges::for_each(topics, write);
    if (!progress(until)) {
      return false;
    }
  } while (until < run.end);
  return true;
}

}  // namespace

bool export_run(const RunRecordings& run, const std::string& folder, const std::string& file,
                const std::function<bool(TimeNs)>& progress) {
  const std::string description = (std::filesystem::path(folder) / "resolved.json").string();
  const std::string text = read_file(description, "description of a run", kLargestDescription);
  const std::string part = file + ".part";  // an older file stays until this one is whole
  bag::Recorder recorder(part, {.patient = true});
  bool whole = false;
  try {
    recorder.attach("resolved.json", "application/json", text);
    whole = write_all(run, recorder, progress);
    if (const bag::Report report = recorder.close(); !report.error.empty()) {
      throw FileError(report.error);
    }
    if (whole) {
      std::filesystem::rename(part, file);
    }
  } catch (...) {
    std::filesystem::remove(part);
    throw;
  }
  if (!whole) {
    std::filesystem::remove(part);
  }
  return whole;
}

}  // namespace spikeloop::app
