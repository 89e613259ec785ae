// What a process of a run shows to the live view, and what the view asks of it: a file of shared
// memory, written by the process and read by spikeloop-live.
//
//   header    positions of the ring, what the view asks
//   channels  one JSON object a line; lines are only added
//   ring      records: channel, time, message
//
// The newest record overwrites the oldest, so a view that is slow or gone never delays the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/live/stop_flag.hpp"

namespace spikeloop::live {

/// The environment variable with the folder of the files; unset: there is no live view.
inline constexpr const char* kFolderVariable = "SPIKELOOP_LIVE";

std::string folder_from_environment();  ///< empty: unset

inline constexpr std::size_t kRingBytes = std::size_t{16} << 20;
/// Size of the file of a process: header, channels and ring.
inline constexpr std::size_t kFeedBytes = 4096 + (std::size_t{2} << 20) + kRingBytes;

/// What people can follow: of a run that follows no clock, until the view asks for another one.
inline constexpr double kFirstSpeed = 1;

/// Messages of one kind; the fields are those of the Foxglove WebSocket protocol.
struct Channel {
  std::string topic;
  std::string encoding;
  std::string schema_name;
  std::string schema_encoding;
  std::string schema;
};

/// A number that the view may change, "encoder.rate_max".
struct Parameter {
  std::string name;
  double value = 0;  ///< at the begin
  double minimum = 0;
  double maximum = 0;
  std::string unit;
};
/// Of one process; more cannot be changed.
inline constexpr std::size_t kMostParameters = 128;

/// What a process tells once, before its channels.
struct About {
  std::string process;
  bool commands = false;  ///< it has a robot to stop
  bool pausable = false;
};

/// The file as both sides have it in memory.
class SharedFile;

/// The side of the process. To be used by one thread, except the const functions.
class Feed {
 public:
  /// Makes the file PROCESS.feed. @throws FileError when there is no room for it.
  Feed(const std::string& folder, const About& about, std::size_t ring_bytes = kRingBytes);
  ~Feed();
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  /// Of publish(). Channels beyond the room for them get no view.
  std::uint32_t add(const Channel& channel);
  /// Of changes(). False: there are too many.
  bool add(const Parameter& parameter);
  /// Copies the message. Never waits. One of more than half the ring is left out, and counted.
  void publish(std::uint32_t channel, TimeNs simulated, std::span<const std::byte> message);

  /// A parameter has another value, though the view did not ask for it.
  void set(std::size_t parameter, double value);
  /// What was told before is not of this part of the run: viewers forget it.
  void begin_anew();

  // What the view asks for now. Without a view for five seconds a run is neither paused nor slow;
  // STOP stays as it is.

  bool stop_pressed() const { return stop_.is_pressed(); }
  bool paused() const;
  /// Ticks that a paused run was asked to make so far.
  std::uint64_t steps() const;
  /// Ratio of simulated to wall time; 0: as fast as possible.
  double speed() const;
  /// Whether a viewer has subscribed to a channel of the run.
  bool watched() const;
  /// Parameters that have changed since the last call, by their numbers, with their values.
  std::vector<std::pair<std::size_t, double>> changes();

 private:
  bool has_view() const;

  StopFlag stop_;
  std::unique_ptr<SharedFile> file_;
  std::uint32_t channels_ = 0;
  std::vector<std::uint32_t> seen_{};  ///< changes of each parameter
  std::uint32_t all_seen_ = 0;
};

/// The side of the view.
class FeedReader {
 public:
  /// @throws FileError: no such file, or not one of ours.
  explicit FeedReader(const std::string& path);
  ~FeedReader();
  FeedReader(FeedReader&&) noexcept;
  FeedReader& operator=(FeedReader&&) noexcept;

  const About& about() const { return about_; }
  /// Channels that are new since the last call, in the order of their numbers.
  std::vector<Channel> new_channels();
  /// Those that were told before the last channel of new_channels().
  const std::vector<Parameter>& parameters() const { return parameters_; }

  struct Record {
    std::uint32_t channel = 0;
    TimeNs time = 0;
    std::span<const std::byte> message;  ///< valid until the next call
  };
  /// The next record; nothing: there is none yet, or beginnings() has to be asked first.
  std::optional<Record> next();
  /// Bytes that were overwritten before they were read, or left out.
  std::uint64_t lost() const;

  /// Counts Feed::begin_anew(); what was told before a new one is not read any more.
  std::uint32_t beginnings();
  void watch();  ///< as Feed::watched()
  void pause(bool paused);
  void step();
  void set_speed(double speed);
  bool paused() const;
  std::uint64_t steps() const;
  double speed() const;
  void change(std::size_t parameter, double value);
  double value(std::size_t parameter) const;

 private:
  std::unique_ptr<SharedFile> file_;
  About about_;
  std::vector<Parameter> parameters_{};
  std::size_t lines_read_ = 0;  // bytes
  std::uint64_t position_ = 0;
  std::uint64_t lost_ = 0;
  std::uint32_t beginnings_ = 0;
  std::vector<std::uint64_t> copy_;
};

}  // namespace spikeloop::live
