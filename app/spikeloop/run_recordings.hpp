// All that the processes of a run recorded, read from its folder.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spikeloop/bag/reader.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::app {

/// One stream of a node.
template <typename Recording>
struct Recorded {
  std::string node;
  std::string name;  ///< of the stream: "out"
  Recording recording;

  std::string end() const { return node + "." + name; }
  /// In the live view, and in an exported file.
  std::string topic() const { return "/" + node + "/" + name; }
};
using RecordedSpikes = Recorded<record::SpikeRecording>;
using RecordedSignal = Recorded<record::SignalRecording>;

struct RunRecordings {
  std::string experiment;  ///< its name
  TimeNs tick = 0;
  TimeNs end = 0;                      ///< everything recorded is before, or at this time
  std::vector<RecordedSpikes> spikes;  ///< in the order of their times
  std::vector<RecordedSignal> signals;
  std::unique_ptr<bag::Reader> messages;  ///< null: there are none
};

/// @throws FileError: a file cannot be read; ConfigurationError: no run with recordings.
RunRecordings read_recordings(const std::string& folder);

}  // namespace spikeloop::app
