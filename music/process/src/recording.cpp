#include "recording.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <vector>

#include "spikeloop/core/log.hpp"
#include "spikeloop/record/recorder.hpp"
#include "spikeloop/status/signals.hpp"

namespace spikeloop::music {
namespace {

// A port of one of the graph's sinks, and what leads to it.
struct Recorded {
  std::string from;
  std::string stream;  ///< the port's name; the sink's and the port's when two have one name
  EndpointPort port;
};

std::vector<Recorded> recorded_ports(const GraphDescription& description) {
  std::vector<Recorded> result;
  std::set<std::string> names;
  for (const auto& entry : description.sinks) {
    const auto ports = entry.sink->ports();
    for (const auto& port : ports) {
      for (const auto& connection : description.connections) {
        const bool only = ports.size() == 1 && connection.to == entry.name;
        if (only || connection.to == entry.name + "." + port.name) {
          const bool is_new = names.insert(port.name).second;
          result.push_back(
              {connection.from, is_new ? port.name : entry.name + ":" + port.name, port});
        }
      }
    }
  }
  return result;
}

class FileRecording : public Recording {
 public:
  FileRecording(GraphDescription& description, const std::string& label)
      : recorder_((output_folder() / (label + ".h5")).string(), label,
                  {description.seed, description.tick}, {.failures = &failures_}),
        on_termination_([this] { recorder_.flush_and_close_from_signal(); }) {
    for (const auto& recorded : recorded_ports(description)) {
      add(description, recorded);
    }
  }
  ~FileRecording() override { FileRecording::close(); }

  void close() override {
    if (closed_) {
      return;
    }
    closed_ = true;
    const auto report = recorder_.close();
    if (!report.error.empty()) {
      log::warning("{}", report.error);
    }
  }

  void check(OnWriteFailure policy) override { failures_.check(policy); }

  std::function<void(TimeNs, double)> value_writer(const std::string& stream,
                                                   const std::string& unit) override {
    return recorder_.value_writer(stream, unit);
  }

 private:
  void add(GraphDescription& description, const Recorded& recorded) {
    const auto& [from, stream, port] = recorded;
    sinks_.push_back(recorder_.output_sink(description, from, {stream, port.kind, port.width}));
    const std::string name = "record " + stream;
    description.sinks.push_back({name, sinks_.back().get()});
    description.connections.push_back({from, name, port.width, 0, {}});
  }

  WriteFailures failures_;
  record::Recorder recorder_;
  std::vector<std::unique_ptr<Sink>> sinks_;
  status::TerminationHook on_termination_;  // gone before what it touches
  bool closed_ = false;
};

}  // namespace

std::filesystem::path output_folder() {
  const char* directory = std::getenv("SPIKELOOP_OUT");
  return directory == nullptr || *directory == '\0' ? "." : directory;
}

std::unique_ptr<Recording> attach_recorders(GraphDescription& description,
                                            const std::string& label) {
  return std::make_unique<FileRecording>(description, label);
}

}  // namespace spikeloop::music
