#include "recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "folder_json.hpp"
#include "spikeloop/config/network_script.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using namespace nlohmann::literals;

[[noreturn]] void refuse(const std::string& folder, const std::string& why) {
  throw ConfigurationError(with_code(Code::no_access, "'{}' cannot be replayed: {}", folder, why));
}

/// Null when there is no such file. @throws ConfigurationError when it is not what a run writes.
json read_json(const std::string& folder, const char* name) {
  const fs::path path = fs::path(folder) / name;
  if (!fs::exists(path)) {
    return nullptr;
  }
  json result = read_folder_json(path.string());
  if (!result.is_object()) {
    refuse(folder, fmt::format("its {} is damaged, or empty; run it again", name));
  }
  return result;
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
    refuse(
        folder,
        "it is not a run folder, there is no resolved.json in it; write the folder that  spikeloop "
        "run FILE.yaml  has named");
  }
  if (resolved.contains("caller")) {
    refuse(folder,
           fmt::format("a program in Python stood for its simulators, {} (Experiment.open); run "
                       "that program again",
                       resolved["caller"].dump()));
  }
  if (!resolved.contains("recorded") || !resolved.contains("experiment_file")) {
    refuse(folder, "an earlier version ran it, which kept no messages; run it again");
  }
}

bool has_topics(const json& resolved) {
  for (const auto& [name, keys] : resolved["nodes"].items()) {
    if (experiment::has_topic(keys.value("node", ""))) {
      return true;
    }
  }
  return false;
}

void check_files(const std::string& folder, const RecordedRun& run) {
  if (!run.summary.is_object()) {
    refuse(folder,
           "there is no summary.json in it: the run has not ended yet, or it was killed; run it "
           "again");
  }
  if (!fs::exists(run.experiment_file)) {
    refuse(folder, fmt::format("there is no {} in it, the copy of the experiment that was run",
                               fused::kExperimentFile));
  }
  if (!run.replay.bag.empty() && !fs::exists(run.replay.bag)) {
    refuse(folder,
           fmt::format("there is no {} in it, the messages that its nodes took; a run whose "
                       "sensors and commands are in several processes has none: use  "
                       "--layout fused",
                       fused::kMessagesFile));
  }
}

/// Whether a connection begins at the node.
bool sends(const json& resolved, const std::string& node) {
  const json connections = resolved.value("connections", json::array());
  return std::ranges::any_of(connections, [&](const json& connection) {
    return experiment::node_of(connection.value("from", "")) == node;
  });
}

/// What every node put out is there, and can be read. A run is no longer than its recordings.
void check_recordings(const std::string& folder, const RecordedRun& run) {
  constexpr double kGrace_s = 1;
  TimeNs end = 0;
  for (const auto& [node, keys] : run.resolved["nodes"].items()) {
    const bool has_output = !keys.contains("simulator") || sends(run.resolved, node);
    if (!has_output || !keys.value("record", true)) {
      continue;
    }
    const std::string file = (fs::path(folder) / (node + ".h5")).string();
    if (!fs::exists(file)) {
      refuse(folder,
             fmt::format("there is no {}.h5 in it, the recording of its node '{}'", node, node));
    }
    end = std::max(end, record::read_info(file).until);
  }
  if (end > 0 && run.simulated_s > to_seconds(end) + kGrace_s) {
    refuse(folder, fmt::format("its summary.json says {:g} s, but its recordings end at {:g} s",
                               run.simulated_s, to_seconds(end)));
  }
}

/// The copies in the folder, when they are all that the experiment reads by a relative path.
std::string origin_of(const std::string& folder, const json& resolved) {
  const fs::path original = resolved["experiment_file"].get<std::string>();
  const json files = resolved.value("files", json::object());
  const std::string world = resolved.value("/robot/world"_json_pointer, "");
  const bool elsewhere = std::ranges::any_of(files.items(), [&](const auto& file) {
    const bool shipped = fs::path(file.key()).stem() == fs::path(world).stem();  // found by name
    return !shipped && fused::copy_of(file.key(), original.string()).empty();
  });
  const fs::path copies = fs::path(folder) / fused::kFilesFolder;
  return fs::exists(copies) && !(elsewhere && fs::exists(original.parent_path()))
             ? (copies / original.filename()).string()
             : original.string();
}

RecordedRun read_experiment(const std::string& folder) {
  RecordedRun run;
  run.folder = folder;
  run.summary = json::object();
  run.resolved = read_json(folder, "resolved.json");
  check_kind(folder, run.resolved);
  run.experiment_file = (fs::path(folder) / fused::kExperimentFile).string();
  run.origin = origin_of(folder, run.resolved);
  run.settings = settings_from_text(run.resolved.value("settings", json::array()).dump());
  if (const fs::path changes = fs::path(folder) / experiment::kChangesFile; fs::exists(changes)) {
    run.changes = changes.string();
  }
  return run;
}

RecordedRun read_run(const std::string& folder) {
  RecordedRun run = read_experiment(folder);
  if (!run.resolved["recorded"].get<bool>()) {
    refuse(folder, "it was run with --no-record; run it without");
  }
  run.summary = read_json(folder, "summary.json");
  run.replay = {has_topics(run.resolved) ? (fs::path(folder) / fused::kMessagesFile).string() : ""};
  check_files(folder, run);
  run.simulated_s = run.summary.at("simulated_s").get<double>();
  run.settings.push_back({"duration", fmt::format("{} s", run.simulated_s), "simulated_s"});
  run.settings.push_back({"sync", "unpaced", "replay"});
  if (run.simulated_s <= 0) {
    refuse(folder, "it was stopped before its first tick; run it again");
  }
  check_recordings(folder, run);
  return run;
}

/// Files may have been named from another directory.
bool same_value(const json& before, const json& now) {
  if (before == now || !before.is_string() || !now.is_string()) {
    return before == now;
  }
  std::error_code error;
  const fs::path file = now.get<std::string>();
  return fs::exists(network_source(file), error) &&  // brain.py:make is of brain.py
         file.filename() == fs::path(before.get<std::string>()).filename();
}

std::vector<std::string> doubts_of_folder(const RecordedRun& run) {
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
      const std::string copy =
          fused::copy_of(path, run.resolved["experiment_file"].get<std::string>());
      const bool whole = !copy.empty() &&
                         file_print((fs::path(run.origin).parent_path() / copy).string()) == print;
      list.push_back(
          fmt::format("'{}' {} since the run: {}", path, now.empty() ? "is gone" : "has changed",
                      whole ? "its copy in the run folder is used" : "spikes may differ"));
    }
  }
  if (const std::string version = run.resolved.value("version", ""); version != SPIKELOOP_VERSION) {
    list.push_back(fmt::format("Spikeloop {} ran it, this is {}: spikes may differ", version,
                               SPIKELOOP_VERSION));
  }
  return list;
}

std::vector<std::string> doubts_of_keys(const RecordedRun& run, const json& resolved_now) {
  std::vector<std::string> list;
  for (const auto& [node, keys] : run.resolved["nodes"].items()) {
    if (!resolved_now["nodes"].contains(node)) {
      list.push_back(fmt::format("node '{}' is gone: spikes may differ", node));
      continue;
    }
    const json& now = resolved_now["nodes"][node];
    for (const auto& [key, value] : keys.items()) {
      if (!same_value(value, now.value(key, json()))) {
        list.push_back(fmt::format("node '{}': key '{}' was {}, it is {} now: spikes may differ",
                                   node, key, value.dump(), now.value(key, json()).dump()));
      }
    }
  }
  for (const auto& [node, keys] : resolved_now["nodes"].items()) {
    if (!run.resolved["nodes"].contains(node)) {
      list.push_back(fmt::format("node '{}' is new: spikes may differ", node));
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

/// What was changed by hand, or written by another version, need not have the types of ours.
template <typename Read>
auto understood(const std::string& folder, Read&& read) {
  try {
    return read();
  } catch (const json::exception& error) {
    refuse(folder, fmt::format("its resolved.json or summary.json does not say what a run writes "
                               "there ({}); run it again",
                               error.what()));
  }
}

}  // namespace

void refuse_own_folder(const std::string& out, const std::string& folder) {
  std::error_code error;
  if (!out.empty() && fs::equivalent(out, folder, error)) {
    throw ConfigurationError(with_code(Code::no_access,
                                       "--out: '{}' is the run itself, which a new run would "
                                       "empty; write another folder, or leave it out",
                                       out));
  }
}

RecordedRun read_recorded_run(const std::string& folder) {
  if (!fs::is_directory(folder)) {
    throw FileError("read", folder, fs::exists(folder) ? ENOTDIR : ENOENT);
  }
  return understood(folder, [&] { return read_run(folder); });
}

RecordedRun read_run_again(const std::string& folder) {
  return understood(folder, [&] { return read_experiment(folder); });
}

std::vector<std::string> doubts(const RecordedRun& run) {
  return understood(run.folder, [&] { return doubts_of_folder(run); });
}

std::vector<std::string> doubts(const RecordedRun& run, const json& resolved_now) {
  return understood(run.folder, [&] { return doubts_of_keys(run, resolved_now); });
}

}  // namespace spikeloop::app
