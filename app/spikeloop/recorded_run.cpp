#include "recorded_run.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "spikeloop/config/files_read.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/experiment/kinds.hpp"
#include "spikeloop/fused/run.hpp"

namespace spikeloop::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

[[noreturn]] void refuse(const std::string& folder, const std::string& why) {
  throw ConfigurationError(fmt::format("'{}' cannot be replayed: {}", folder, why));
}

/// Null when there is no such file, or no JSON in it.
json read_json(const fs::path& path) {
  std::ifstream file(path);
  json result = json::parse(file, nullptr, false);
  return result.is_object() ? result : json(nullptr);
}

/// Of another kind, or of no run at all.
void check_kind(const std::string& folder, const json& resolved) {
  const fs::path path(folder);
  if (!resolved.is_object() || !resolved.value("nodes", json()).is_object()) {
    if (fs::exists(path / "effective.music")) {
      refuse(folder,
             "it is the run of a .music file, whose messages are not recorded; its recordings "
             "(record=true) are sources for spike_playback and signal_playback");
    }
    refuse(folder,
           "it is no run folder, there is no resolved.json in it; write the folder that  spikeloop "
           "run FILE.yaml  has named");
  }
  if (!resolved.contains("recorded") || !resolved.contains("experiment_file")) {
    refuse(folder, fs::exists(path / "experiment.music")
                       ? "it was run with --layout separate, which keeps no messages; run the "
                         "experiment without it"
                       : "an earlier version ran it, which kept no messages; run it once more");
  }
  if (!resolved["recorded"].get<bool>()) {
    refuse(folder, "it was run with --no-record; run it without");
  }
}

bool has_topics(const json& resolved) {
  for (const auto& [name, keys] : resolved["nodes"].items()) {
    const std::string kind = keys.value("node", "");
    if (kind == experiment::kRosSensor || kind == experiment::kRosCommand) {
      return true;
    }
  }
  return false;
}

void check_files(const std::string& folder, const RecordedRun& run) {
  if (!run.summary.is_object()) {
    refuse(folder,
           "there is no summary.json in it: the run has not ended yet, or it was killed; run it "
           "once more");
  }
  if (!fs::exists(run.experiment_file)) {
    refuse(folder, fmt::format("there is no {} in it, the copy of the experiment that was run",
                               fused::kExperimentFile));
  }
  if (!run.replay.bag.empty() && !fs::exists(run.replay.bag)) {
    refuse(folder, fmt::format("there is no {} in it, the messages that its nodes took",
                               fused::kMessagesFile));
  }
}

/// Files may have been named from another directory.
bool same_value(const json& before, const json& now) {
  if (before == now || !before.is_string() || !now.is_string()) {
    return before == now;
  }
  std::error_code error;
  const fs::path file = now.get<std::string>();
  return fs::exists(file, error) &&
         file.filename() == fs::path(before.get<std::string>()).filename();
}

}  // namespace

RecordedRun read_recorded_run(const std::string& folder) {
  if (!fs::is_directory(folder)) {
    throw FileError("read", folder, fs::exists(folder) ? ENOTDIR : ENOENT);
  }
  const fs::path path(folder);
  RecordedRun run;
  run.folder = folder;
  run.resolved = read_json(path / "resolved.json");
  check_kind(folder, run.resolved);
  run.summary = read_json(path / "summary.json");
  run.experiment_file = (path / fused::kExperimentFile).string();
  run.replay = {run.resolved["experiment_file"],
                has_topics(run.resolved) ? (path / fused::kMessagesFile).string() : ""};
  check_files(folder, run);
  run.simulated_s = run.summary.value("simulated_s", 0.0);
  run.seed = run.resolved.value("seed", std::uint64_t{1});
  return run;
}

std::vector<std::string> doubts(const RecordedRun& run) {
  std::vector<std::string> list;
  const auto dropped = [&](const char* key, const char* what) {
    if (const auto count = run.summary.value(key, std::uint64_t{0}); count > 0) {
      list.push_back(fmt::format("the run lost {} {}, as the disk was too slow: spikes may differ",
                                 count, what));
    }
  };
  dropped("messages_dropped", "messages");
  dropped("records_dropped", "recorded items");
  const json files = run.resolved.value("files", json::object());
  for (const auto& [path, print] : files.items()) {
    if (const std::string now = file_print(path); now != print) {
      list.push_back(fmt::format("'{}' {} since the run: spikes may differ", path,
                                 now.empty() ? "is gone" : "has changed"));
    }
  }
  if (const std::string version = run.resolved.value("version", ""); version != SPIKELOOP_VERSION) {
    list.push_back(fmt::format("Spikeloop {} ran it, this is {}: spikes may differ", version,
                               SPIKELOOP_VERSION));
  }
  return list;
}

std::vector<std::string> doubts(const RecordedRun& run, const json& resolved_now) {
  std::vector<std::string> list;
  for (const auto& [node, keys] : run.resolved["nodes"].items()) {
    const json now = resolved_now["nodes"].value(node, json::object());
    for (const auto& [key, value] : keys.items()) {
      if (!same_value(value, now.value(key, json()))) {
        list.push_back(fmt::format("node '{}': key '{}' was {}, it is {} now: spikes may differ",
                                   node, key, value.dump(), now.value(key, json()).dump()));
      }
    }
  }
  for (const char* key : {"connections", "tick_ns"}) {
    if (run.resolved.value(key, json()) != resolved_now[key]) {
      list.push_back(
          fmt::format("'{}' of the experiment are no longer those of the run: spikes may "
                      "differ",
                      key));
    }
  }
  return list;
}

}  // namespace spikeloop::app
