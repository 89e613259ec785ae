#include "cycles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "spikeloop/launch/effective_file.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::launch {
namespace {

constexpr std::size_t kMostCycles = 10'000;

/// Walks every chain of connections from one application, over applications that are listed after
/// it, so that each cycle is found once: from its first application.
class CycleSearch {
 public:
  explicit CycleSearch(const MusicFile& file) : file_(file), labels_(file.labels()) {}

  std::vector<Cycle> run() {
    for (first_ = 0; first_ < labels_.size(); ++first_) {
      walk(labels_[first_]);
    }
    return std::move(found_);
  }

 private:
  std::size_t place(const std::string& label) const {
    return static_cast<std::size_t>(std::find(labels_.begin(), labels_.end(), label) -
                                    labels_.begin());
  }

  bool on_path(const std::string& label) const {
    return std::any_of(path_.begin(), path_.end(),
                       [&](std::size_t i) { return file_.connections[i].from_app == label; });
  }

  void walk(const std::string& from) {
    for (std::size_t i = 0; i < file_.connections.size() && found_.size() < kMostCycles; ++i) {
      const MusicConnection& connection = file_.connections[i];
      if (connection.from_app != from) {
        continue;
      }
      path_.push_back(i);
      if (connection.to_app == labels_[first_]) {
        found_.push_back(path_);
      } else if (place(connection.to_app) > first_ && !on_path(connection.to_app)) {
        walk(connection.to_app);
      }
      path_.pop_back();
    }
  }

  const MusicFile& file_;
  std::vector<std::string> labels_;
  std::size_t first_ = 0;
  Cycle path_;
  std::vector<Cycle> found_;
};

bool takes_events(const MusicFile& file, const std::string& label) {
  const Program* program = find_program(file, label);
  return program != nullptr && program->input == PortKind::spikes;
}

std::optional<TimeNs> written_latency(const MusicFile& file, const MusicSection& section) {
  const auto latency_s = number_of(file, section, "accept_latency", "s");
  try {
    return latency_s ? std::optional(from_seconds(*latency_s)) : std::nullopt;
  } catch (const ConfigurationError&) {
    return std::nullopt;  // longer than time itself: the program reports it
  }
}

std::string names(const MusicFile& file, const Cycle& cycle) {
  std::string text = file.connections[cycle.front()].from_app;
  for (const std::size_t i : cycle) {
    text += " -> " + file.connections[i].to_app;
  }
  return text;
}

/// Gives the free receivers of one cycle what it lacks.
void serve(const MusicFile& file, const Cycle& cycle, Latencies& latencies) {
  TimeNs lacking = 0;
  std::vector<std::string> free;
  for (const std::size_t i : cycle) {
    const MusicConnection& connection = file.connections[i];
    const MusicSection& receiver = file.section(connection.to_app);
    lacking += tick_of(file, file.section(connection.from_app));
    const Program* program = find_program(file, receiver);
    if (is_continuous(file, connection) || program == nullptr) {
      continue;
    }
    // A script's user knows what may come late, and writes it.
    if (const auto written = written_latency(file, receiver)) {
      lacking -= *written;
    } else if (program->input == PortKind::spikes) {
      free.push_back(connection.to_app);
    }
  }
  if (lacking <= 0) {
    return;
  }
  if (free.empty()) {
    latencies.warnings.push_back(fmt::format(
        "the cycle {} lacks {} of acceptable latency, and no spike input of ours in it is free to "
        "accept it; MUSIC ends such a job with 'too short latency': let one of its programs accept "
        "more (accept_latency, or nest.SetAcceptableLatency)",
        names(file, cycle), format_time(lacking)));
    return;
  }
  const auto count = static_cast<TimeNs>(free.size());
  const TimeNs share = (lacking + count - 1) / count;
  for (const std::string& label : free) {
    latencies.by_label[label] = std::max(latencies.by_label[label], share);
  }
}

}  // namespace

std::vector<Cycle> find_cycles(const MusicFile& file) {
  return CycleSearch(file).run();
}

Latencies choose_latencies(const MusicFile& file) {
  Latencies latencies;
  for (const MusicSection& section : file.sections) {
    if (takes_events(file, section.label)) {
      latencies.by_label[section.label] = written_latency(file, section).value_or(0);
    }
  }
  for (const Cycle& cycle : find_cycles(file)) {
    serve(file, cycle, latencies);
  }
  return latencies;
}

}  // namespace spikeloop::launch
