// Recorders for whatever a process puts out.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "spikeloop/core/graph.hpp"
#include "spikeloop/core/write_failures.hpp"

namespace spikeloop::music {

/// A file being written; closing it twice is closing it once.
class Recording {
 public:
  virtual ~Recording() = default;
  virtual void close() = 0;
  /// To be called every tick, as WriteFailures::check().
  virtual void check(OnWriteFailure policy) = 0;
  /// As record::Recorder::value_writer().
  virtual std::function<void(TimeNs, double)> value_writer(const std::string& stream,
                                                           const std::string& unit) = 0;
};

/// $SPIKELOOP_OUT, or the working directory when that is not set.
std::filesystem::path output_folder();

/// For every connection into a sink of the graph: a recorder of the same output. The file is
/// LABEL.h5 in output_folder().
std::unique_ptr<Recording> attach_recorders(GraphDescription& description,
                                            const std::string& label);

}  // namespace spikeloop::music
