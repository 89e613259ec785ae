// The JSON messages of music-adapters and gymz, as text.
//
//   FloatArray      [x, ...]
//   GymObservation  [{"value": v, "min": a, "max": b, "ts": unix_s}, ...]   also rewards
//   GymCommand      [{"value": x, "ts": unix_s, "max": b, "min": a}, ...]
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop::zmq {

/// From a message to the channels of a port. A FloatArray is taken as it is; a value of a
/// GymObservation as 2 (v - min) / (max - min) - 1, limited to [-1, 1].
/// An entry without a finite value in a finite, non-empty range is not a reading: the channel keeps
/// what it had (NaN before the first).
class ObservationReader {
 public:
  struct Counts {
    std::uint64_t messages = 0;
    std::uint64_t cropped = 0;           ///< with more values than the port has channels
    std::uint64_t short_messages = 0;    ///< with fewer: the channels without one keep theirs
    std::uint64_t invalid_readings = 0;  ///< entries
    std::uint64_t malformed = 0;         ///< no JSON array: left out
    std::uint64_t late = 0;              ///< with a time stamp more than 10 ms ago (gymz's limit)
  };

  /// @param type "FloatArray" or "GymObservation"
  /// @throws ConfigurationError for another type
  ObservationReader(std::string_view type, std::uint32_t width, bool strict);

  /// Updates channels(). False: the message was malformed and changed nothing.
  /// @param now_unix_s to judge time stamps
  /// @throws ConfigurationError naming both widths when `strict` and they differ
  bool read(std::string_view message, double now_unix_s);

  std::span<const double> channels() const { return channels_; }
  const Counts& counts() const { return counts_; }
  /// What the last read() found worth telling, once a kind; else empty.
  std::string take_warning();

 private:
  void fit(std::size_t count);

  bool gym_;
  bool strict_;
  std::vector<double> channels_;
  Counts counts_;
  std::string warning_;
};

/// [0.5,-1]
std::string float_array(std::span<const double> values);

/// [{"max":1,"min":-1,"ts":1700000000.5,"value":0.5}, ...]: the values as they are.
std::string gym_command(std::span<const double> values, double minimum, double maximum,
                        double now_unix_s);

}  // namespace spikeloop::zmq
