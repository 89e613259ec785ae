// Writes the spikes and signals of one process to one HDF5 file, off the loop's thread.
//
// Layout of a file (docs/run-folder.md shows how to read it):
//   /spikes/STREAM/timestamps     float64, ms          SONATA report
//   /spikes/STREAM/node_ids       uint64, 0-based
//   /spikes/STREAM/timestamps_ns  int64, ns, exact
//   /spikes/STREAM                attributes `populations`, `population_sizes`: names, numbers of
//                                 channels, in the order of the channels
//   /signals/STREAM/times_ns      int64, ns; one row where the signal's revision changed
//   /signals/STREAM/values        float64, rows x width, attribute `unit`
// A value holds from its time until the next row's time. Spikes stand in the order in which the
// loop saw them, which is by time unless some came late.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "spikeloop/core/graph.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/core/write_failures.hpp"

namespace spikeloop::record {

/// Number of the file layout above; raised when a reader of the old one would go wrong.
inline constexpr std::uint32_t kFormat = 1;

/// What stands in the file's attributes beside process, format and version.
struct RunAttributes {
  std::uint64_t seed = 1;
  TimeNs tick = 0;  ///< ns
};

struct RecorderOptions {
  /// Spikes that wait for the writer, per stream.
  std::size_t spike_capacity = std::size_t{1} << 18;
  /// Values (rows x (width + 1)) that wait for the writer, per stream; at least `least_rows`, but
  /// fewer for streams so wide that they would need more than 64 MB.
  std::size_t value_capacity = std::size_t{1} << 17;
  std::size_t least_rows = 4096;
  /// The loop waits for the writer in place of dropping: for runs that no clock hurries.
  bool patient = false;
  /// What a killed process loses at most; wall time.
  TimeNs flush_every = kNsPerSecond;
  /// Receives the first failed write. nullptr: only the report of close() has it.
  WriteFailures* failures = nullptr;
};

/// What became of everything that was sent.
struct Report {
  std::uint64_t spikes_written = 0;
  std::uint64_t spikes_dropped = 0;
  std::uint64_t signals_written = 0;  ///< rows
  std::uint64_t signals_dropped = 0;  ///< rows
  std::string error;                  ///< one sentence; empty when the file could be written
};

class Writer;

/// One file. A single thread writes all files of the process. Sinks only append to a bounded buffer
/// that is free of locks: a full buffer or a full disk never holds up the loop, unless it is
/// patient; what is lost is counted.
class Recorder {
 public:
  /// Makes the file, replacing one of the same name.
  /// @throws FileError when it cannot be made.
  Recorder(const std::string& path, const std::string& process, const RunAttributes& attributes,
           const RecorderOptions& options = {});
  /// Closes.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// A sink with one spike port "in". Counter: spikes_dropped.
  /// `populations`: empty, or of `width` neurons together.
  /// @throws ConfigurationError for a stream that exists, an empty name or one with '/'.
  std::unique_ptr<Sink> spike_sink(const std::string& stream, std::uint32_t width,
                                   const std::vector<Population>& populations = {});

  /// A sink with one signal port "in". A row is written when the revision has changed; a signal
  /// that turns invalid is written as a row of NaN. `channels`: names of the channels
  /// ("linear.x"), or empty. Counter: signals_dropped (rows).
  /// @throws ConfigurationError as spike_sink(), when `channels` is neither empty nor as long as
  /// `width`, and when the rows of a tenth of a second need too much memory.
  std::unique_ptr<Sink> signal_sink(const std::string& stream, std::uint32_t width,
                                    const std::string& unit,
                                    const std::vector<std::string>& channels = {});

  /// One of the two, for the output `end` of a graph, with the unit and the names that its port
  /// has.
  std::unique_ptr<Sink> output_sink(const GraphDescription& description, const std::string& end,
                                    const EndpointPort& port);

  /// For numbers that no port has: a signal of one channel, a row a call. To be called in one
  /// thread, with times that do not go back; as free of locks as a sink.
  /// @throws ConfigurationError as spike_sink().
  std::function<void(TimeNs time, double value)> value_writer(const std::string& stream,
                                                              const std::string& unit);

  /// Asks the writer to close the file, and does not wait: many files are closed in one pass.
  /// Async-signal-safe.
  void begin_close() noexcept;

  /// Writes what waits, closes the file, ends the writer. Whatever is sent later is counted as
  /// dropped. A second call gives the same report. Never throws.
  Report close();

  /// As close(), safe in a signal handler and in any thread: asks the writer and waits for it.
  /// False when the writer is not ready after `patience` (then the last second may be missing).
  bool flush_and_close_from_signal(TimeNs patience = kNsPerSecond / 2) noexcept;

 private:
  struct Impl;
  std::shared_ptr<Writer> writer_;
  std::shared_ptr<Impl> impl_;
};

}  // namespace spikeloop::record
