#include "run_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "recorded_run.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/live/neural_messages.hpp"
#include "spikeloop/live/status.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::app {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr TimeNs kStatusPeriod = kNsPerSecond / 10;  // wall time
/// What the page shows of the time before.
constexpr TimeNs kHistory = 2 * kNsPerSecond;
/// A machine that stood still does not skip a part of the run.
constexpr TimeNs kLongestStep = kNsPerSecond / 5;
constexpr std::size_t kTimeBar = 0;  // the only parameter

template <typename Times, typename TimeOf>
std::size_t first_after(const Times& times, TimeNs time, TimeOf&& time_of) {
  return static_cast<std::size_t>(std::ranges::upper_bound(times, time, {}, time_of) -
                                  times.begin());
}

}  // namespace

RunPlayer::RunPlayer(const std::string& folder) : folder_(folder) {
  const RecordedRun run = read_run_again(folder);
  name_ = run.resolved.value("experiment", "");
  tick_ = run.resolved.value("tick_ns", kNsPerSecond / 1000);
  for (const auto& [node, keys] : run.resolved["nodes"].items()) {
    read_recordings(node);
  }
  if (spikes_.empty() && signals_.empty()) {
    throw ConfigurationError(
        with_code(Code::missing_file,
                  "'{}' has no recordings; run the experiment without --no-record", folder));
  }
  if (fs::exists(fs::path(folder) / fused::kMessagesFile)) {
    messages_ = std::make_unique<bag::Reader>((fs::path(folder) / fused::kMessagesFile).string());
    end_ = std::max(end_, messages_->end());
  }
}

void RunPlayer::read_recordings(const std::string& node) {
  const std::string file = (fs::path(folder_) / (node + ".h5")).string();
  if (!fs::exists(file)) {
    return;
  }
  const record::FileInfo info = record::read_info(file);
  end_ = std::max(end_, info.until);
  for (const std::string& stream : info.spikes) {
    spikes_.push_back({fmt::format("{}.{}", node, stream), record::read_spikes(file, stream)});
    std::ranges::stable_sort(spikes_.back().recording.spikes, spike_before);
  }
  for (const std::string& stream : info.signals) {
    signals_.push_back({fmt::format("{}.{}", node, stream), record::read_signal(file, stream)});
  }
}

void RunPlayer::open(const std::string& feeds) {
  feed_ = std::make_unique<live::Feed>(
      feeds, live::About{.process = "recording", .commands = false, .pausable = true});
  status_ = feed_->add(live::status_channel());
  feed_->add(live::Parameter{"run.time", 0, 0, to_seconds(end_), "s"});
  const auto topic_of = [](std::string end) {
    std::ranges::replace(end, '.', '/');
    return "/" + end;
  };
  for (Spikes& spikes : spikes_) {
    spikes.channel = feed_->add(live::spike_channel(topic_of(spikes.end)));
  }
  for (Signal& signal : signals_) {
    signal.channel = feed_->add(live::signal_channel(topic_of(signal.end)));
  }
  read_messages();
}

void RunPlayer::read_messages() {
  if (!messages_) {
    return;
  }
  for (const bag::Connection& connection : messages_->connections()) {
    if (!connection.dialect) {
      continue;
    }
    const messages::Schema schema = messages::schema_of(*connection.dialect, connection.type);
    topics_.push_back({connection, messages_->stream(connection.topic, connection.node),
                       feed_->add({connection.topic, schema.encoding, schema.type,
                                   schema.definition_encoding, schema.definition})});
  }
}

void RunPlayer::advance(TimeNs now) {
  const TimeNs passed = std::min(now - asked_, kLongestStep);
  asked_ = now;
  for (const auto& [number, value] : feed_->changes()) {
    go_to(from_seconds(value));
  }
  if (feed_->paused()) {
    const std::uint64_t steps = feed_->steps() - steps_;
    play(std::min(end_, time_ + static_cast<TimeNs>(steps) * tick_));
  } else {
    const double speed = feed_->speed();
    const double next =
        static_cast<double>(time_) +
        (speed > 0 ? speed * static_cast<double>(passed) : static_cast<double>(end_ - time_));
    play(std::min(end_, static_cast<TimeNs>(next)));
  }
  steps_ = feed_->steps();
  if (now >= next_status_) {
    next_status_ = now + kStatusPeriod;
    tell();
  }
}

/// What lies in (time_, until]: all spikes, the newest values and messages.
void RunPlayer::play(TimeNs until) {
  if (until <= time_) {
    return;
  }
  for (Spikes& spikes : spikes_) {
    std::vector<std::int64_t> times;
    std::vector<std::uint32_t> channels;
    const auto& all = spikes.recording.spikes;
    for (; spikes.next < all.size() && all[spikes.next].time_ns <= until; ++spikes.next) {
      times.push_back(all[spikes.next].time_ns);
      channels.push_back(static_cast<std::uint32_t>(all[spikes.next].channel));
    }
    if (!times.empty()) {
      live::write_spikes(times, channels, message_);
      feed_->publish(spikes.channel, until, message_);
    }
  }
  for (Signal& signal : signals_) {
    const std::size_t next = first_after(signal.recording.times, until, std::identity());
    if (next > signal.next) {
      signal.next = next;
      live::write_signal(signal.recording.row(next - 1), message_);
      feed_->publish(signal.channel, signal.recording.times[next - 1], message_);
    }
  }
  for (Topic& topic : topics_) {
    std::vector<std::byte> newest;
    TimeNs time = -1;
    while ((topic.waiting || (topic.waiting = topic.stream.next())) &&
           topic.waiting->time <= until) {
      newest.assign(topic.waiting->bytes.begin(), topic.waiting->bytes.end());
      time = topic.waiting->time;
      topic.waiting.reset();
    }
    if (time >= 0) {
      feed_->publish(topic.channel, time, newest);
    }
  }
  time_ = until;
  feed_->set(kTimeBar, to_seconds(time_));
}

/// The page begins anew, a little before, so that it has something to show.
void RunPlayer::go_to(TimeNs time) {
  const TimeNs begin = std::max<TimeNs>(0, time - kHistory);
  feed_->begin_anew();
  for (Spikes& spikes : spikes_) {
    spikes.next = first_after(spikes.recording.spikes, begin, &Spike::time_ns);
  }
  for (Signal& signal : signals_) {
    signal.next = 0;
  }
  for (Topic& topic : topics_) {
    topic.stream = messages_->stream(topic.connection.topic, topic.connection.node);
    topic.waiting.reset();
  }
  time_ = begin;
  constexpr TimeNs kPiece = kNsPerSecond / 50;
  while (time_ < std::min(time, end_)) {
    play(std::min({time_ + kPiece, time, end_}));
  }
}

/// It never ends: one can go back.
void RunPlayer::tell() {
  const json status{
      {"process", "recording"},
      {"simulated_s", to_seconds(time_)},
      {"wall_s", to_seconds(asked_)},
      {"paused", feed_->paused()},
      {"ended", false},
      {"changeable",
       {{{"name", "run.time"}, {"minimum", 0}, {"maximum", to_seconds(end_)}, {"unit", "s"}}}},
      {"commands", json::array()},
      {"spikes", spike_counts()}};
  const std::string text = status.dump();
  feed_->publish(status_, time_, std::as_bytes(std::span(text)));
}

json RunPlayer::spike_counts() const {
  json counts = json::object();
  for (const Spikes& spikes : spikes_) {
    counts[spikes.end] = spikes.next;
  }
  return counts;
}

}  // namespace spikeloop::app
