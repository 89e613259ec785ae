#include "run_recordings.hpp"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "folder_json.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/fused/run.hpp"

namespace spikeloop::app {
namespace {

using nlohmann::json;

void read_node(const std::string& folder, const std::string& node, RunRecordings& run) {
  const std::string file = (std::filesystem::path(folder) / (node + ".h5")).string();
  if (!std::filesystem::exists(file)) {
    return;
  }
  const record::FileInfo info = record::read_info(file);
  run.end = std::max(run.end, info.until);
  for (const std::string& stream : info.spikes) {
    run.spikes.push_back({node, stream, record::read_spikes(file, stream)});
    auto& spikes = run.spikes.back().recording.spikes;
    if (!std::ranges::is_sorted(spikes, spike_before)) {
      std::ranges::stable_sort(spikes, spike_before);
    }
    run.end = std::max(run.end, spikes.empty() ? 0 : spikes.back().time_ns);
  }
  for (const std::string& stream : info.signals) {
    run.signals.push_back({node, stream, record::read_signal(file, stream)});
    const auto& times = run.signals.back().recording.times;
    run.end = std::max(run.end, times.empty() ? 0 : times.back());
  }
}

[[noreturn]] void refuse_to_show(const std::string& folder, const char* why) {
  throw ConfigurationError(with_code(Code::no_access, "'{}' cannot be shown: {}", folder, why));
}

json read_description(const std::string& folder) {
  const auto path = std::filesystem::path(folder);
  if (!std::filesystem::exists(path / "resolved.json")) {
    refuse_to_show(folder, std::filesystem::exists(path / "effective.music")
                               ? "it is the run of a .music file;  spikeloop plot  draws it"
                               : "it is not a run folder, there is no resolved.json in it; write "
                                 "the folder that  spikeloop run FILE.yaml  has named");
  }
  const json resolved = read_folder_json((path / "resolved.json").string());
  if (!resolved.is_object() || !resolved.value("nodes", json()).is_object() ||
      !resolved.value("experiment", json("")).is_string() ||
      !resolved.value("tick_ns", json(1)).is_number_integer()) {
    refuse_to_show(folder, "its resolved.json is damaged; run the experiment again");
  }
  return resolved;
}

}  // namespace

RunRecordings read_recordings(const std::string& folder) {
  const json resolved = read_description(folder);
  RunRecordings recordings;
  recordings.experiment = resolved.value("experiment", "");
  recordings.tick = resolved.value("tick_ns", kNsPerSecond / 1000);
  for (const auto& [node, keys] : resolved["nodes"].items()) {
    read_node(folder, node, recordings);
  }
  if (recordings.spikes.empty() && recordings.signals.empty()) {
    throw ConfigurationError(
        with_code(Code::missing_file,
                  "'{}' has no recordings; run the experiment without --no-record", folder));
  }
  const auto messages = std::filesystem::path(folder) / fused::kMessagesFile;
  if (std::filesystem::exists(messages)) {
    recordings.messages = std::make_unique<bag::Reader>(messages.string());
    for (const std::string& warning : recordings.messages->warnings()) {
      log::warning("{}", warning);
    }
    recordings.end = std::max(recordings.end, recordings.messages->end());
  }
  return recordings;
}

}  // namespace spikeloop::app
