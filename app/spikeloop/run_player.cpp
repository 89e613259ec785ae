#include "run_player.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "spikeloop/live/neural_messages.hpp"
#include "spikeloop/live/status.hpp"

namespace spikeloop::app {
namespace {

using nlohmann::json;

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

RunPlayer::RunPlayer(const RunRecordings& recordings, const std::string& feeds)
    : run_(recordings),
      feed_(feeds, live::About{.process = "recording", .commands = false, .pausable = true}),
      status_(feed_.add(live::status_channel())) {
  feed_.add(live::Parameter{"run.time", 0, 0, to_seconds(run_.end), "s"});
  for (const RecordedSpikes& spikes : run_.spikes) {
    spikes_.push_back({&spikes, feed_.add(live::spike_channel(spikes.topic()))});
  }
  for (const RecordedSignal& signal : run_.signals) {
    signals_.push_back({&signal, feed_.add(live::signal_channel(signal.topic()))});
  }
  add_messages();
}

void RunPlayer::add_messages() {
  if (!run_.messages) {
    return;
  }
  for (const bag::Connection& connection : run_.messages->connections()) {
    if (connection.dialect) {
      const messages::Schema& schema = connection.schema;
      topics_.push_back({connection, run_.messages->stream(connection.topic, connection.node),
                         feed_.add({connection.topic, schema.encoding, schema.type,
                                    schema.definition_encoding, schema.definition})});
    }
  }
}

void RunPlayer::advance(TimeNs now) {
  const TimeNs passed = std::min(now - asked_, kLongestStep);
  asked_ = now;
  for (const auto& [number, value] : feed_.changes()) {
    go_to(from_seconds(value));
  }
  if (time_ < wanted_) {
    catch_up();
  } else if (feed_.watched()) {
    go_on(passed);
  }
  if (now >= next_status_) {
    next_status_ = now + kStatusPeriod;
    tell();
  }
}

void RunPlayer::go_on(TimeNs passed) {
  if (feed_.paused()) {
    const std::uint64_t steps = feed_.steps() - steps_;
    play(std::min(run_.end, time_ + static_cast<TimeNs>(steps) * run_.tick));
  } else {
    const double speed = feed_.speed();
    const double next =
        static_cast<double>(time_) +
        (speed > 0 ? speed * static_cast<double>(passed) : static_cast<double>(run_.end - time_));
    play(std::min(run_.end, static_cast<TimeNs>(next)));
  }
  steps_ = feed_.steps();
}

/// What lies in (time_, until]: all spikes, the newest values and messages.
void RunPlayer::play(TimeNs until) {
  if (until <= time_) {
    return;
  }
  for (Spikes& spikes : spikes_) {
    std::vector<std::int64_t> times;
    std::vector<std::uint32_t> channels;
    const auto& all = spikes.of->recording.spikes;
    for (; spikes.next < all.size() && all[spikes.next].time_ns <= until; ++spikes.next) {
      times.push_back(all[spikes.next].time_ns);
      channels.push_back(static_cast<std::uint32_t>(all[spikes.next].channel));
    }
    if (!times.empty()) {
      live::write_spikes(times, channels, message_);
      publish(spikes.channel, until, message_);
    }
  }
  for (Signal& signal : signals_) {
    const std::size_t next = first_after(signal.of->recording.times, until, std::identity());
    if (next > signal.next) {
      signal.next = next;
      live::write_signal(signal.of->recording.row(next - 1), message_);
      publish(signal.channel, signal.of->recording.times[next - 1], message_);
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
      publish(topic.channel, time, newest);
    }
  }
  time_ = until;
  feed_.set(kTimeBar, to_seconds(time_));
}

/// The page begins anew, a little before, so that it has something to show.
void RunPlayer::go_to(TimeNs time) {
  const TimeNs begin = std::max<TimeNs>(0, time - kHistory);
  feed_.begin_anew();
  for (Spikes& spikes : spikes_) {
    spikes.next = first_after(spikes.of->recording.spikes, begin, &Spike::time_ns);
  }
  for (Signal& signal : signals_) {
    signal.next = 0;
  }
  for (Topic& topic : topics_) {
    topic.stream = run_.messages->stream(topic.connection.topic, topic.connection.node);
    topic.waiting.reset();
  }
  time_ = begin;
  wanted_ = std::min(time, run_.end);
}

/// No more at once than the view can read meanwhile.
void RunPlayer::catch_up() {
  constexpr TimeNs kPiece = kNsPerSecond / 50;
  for (const std::size_t before = published_;
       time_ < wanted_ && published_ - before < live::kRingBytes / 4;) {
    play(std::min(time_ + kPiece, wanted_));
  }
}

void RunPlayer::publish(std::uint32_t channel, TimeNs time, const std::vector<std::byte>& message) {
  feed_.publish(channel, time, message);
  published_ += message.size();
}

/// It never ends: one can go back.
void RunPlayer::tell() {
  const json status{
      {"process", "recording"},
      {"simulated_s", to_seconds(time_)},
      {"wall_s", to_seconds(asked_)},
      {"paused", feed_.paused()},
      {"ended", false},
      {"changeable",
       {{{"name", "run.time"}, {"minimum", 0}, {"maximum", to_seconds(run_.end)}, {"unit", "s"}}}},
      {"commands", json::array()},
      {"spikes", spike_counts()}};
  const std::string text = status.dump();
  feed_.publish(status_, time_, std::as_bytes(std::span(text)));
}

json RunPlayer::spike_counts() const {
  json counts = json::object();
  for (const Spikes& spikes : spikes_) {
    counts[spikes.of->end()] = spikes.next;
  }
  return counts;
}

}  // namespace spikeloop::app
