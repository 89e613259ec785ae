// Reads what recorder.hpp wrote: for tests, plots and replay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/signal.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::record {

/// Of the HDF5 library that was loaded: "1.10.8".
std::string library_version();

struct FileInfo {
  std::string process;
  std::string version;  ///< of the Spikeloop that wrote the file
  std::uint32_t format = 0;
  std::uint64_t seed = 0;
  TimeNs tick = 0;
  bool complete = false;             ///< false: still open, or its process was killed
  std::vector<std::string> spikes;   ///< names of the streams, sorted
  std::vector<std::string> signals;  ///< names of the streams, sorted
  TimeNs until = 0;                  ///< the latest of the streams'
};

struct SpikeRecording {
  std::vector<Spike> spikes;  ///< in recorded order
  std::uint32_t width = 0;
  TimeNs until = 0;           ///< everything up to this simulated time is in the file
  std::uint64_t dropped = 0;  ///< spikes that the recorder lost
};

struct SignalRecording {
  std::vector<TimeNs> times;   ///< of the rows; a value holds until the next row's time
  std::vector<double> values;  ///< rows x width
  std::uint32_t width = 0;
  std::string unit;
  std::vector<std::string> channels;  ///< empty when the channels have no names
  TimeNs until = 0;                   ///< the last row holds until here
  std::uint64_t dropped = 0;          ///< rows that the recorder lost

  std::span<const double> row(std::size_t i) const {
    return std::span(values).subspan(i * width, width);
  }
};

/// @throws FileError when the file is missing, no HDF5, not ours, or of a newer format.
FileInfo read_info(const std::string& path);

/// Reads the whole of it in a copy of this process: for other programs that read it by HDF5, which
/// crashes on some damaged files. @throws FileError: HDF5 crashes or hangs.
void try_recording(const std::string& path);

/// @throws FileError as read_info(); ConfigurationError for an unknown stream (did you mean).
SpikeRecording read_spikes(const std::string& path, const std::string& stream);
SignalRecording read_signal(const std::string& path, const std::string& stream);

}  // namespace spikeloop::record
