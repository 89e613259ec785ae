#include "spike_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "spikeloop/record/reader.hpp"

namespace spikeloop::app {
namespace {

struct Difference {
  TimeNs time = 0;
  std::string text;
};

std::vector<Spike> spikes_of(const std::string& file, const std::string& stream, TimeNs until) {
  auto spikes = record::read_spikes(file, stream).spikes;
  std::erase_if(spikes, [until](const Spike& spike) { return spike.time_ns > until; });
  return spikes;
}

std::string text_of(const Spike& spike) {
  return fmt::format("channel {} at {}.{:09} s", spike.channel, spike.time_ns / kNsPerSecond,
                     spike.time_ns % kNsPerSecond);
}

/// The first place at which one of the two goes on otherwise.
std::optional<Difference> first_difference(const std::string& node, const std::vector<Spike>& run,
                                           const std::vector<Spike>& replay) {
  const auto same = [](const Spike& a, const Spike& b) {
    return a.time_ns == b.time_ns && a.channel == b.channel;
  };
  const auto [mine, theirs] = std::ranges::mismatch(run, replay, same);
  if (mine == run.end() && theirs == replay.end()) {
    return std::nullopt;
  }
  const std::string begin = fmt::format("the spikes of node '{}' differ first: ", node);
  if (theirs == replay.end()) {
    return Difference{mine->time_ns,
                      begin + "the run has one in " + text_of(*mine) + ", the replay none"};
  }
  if (mine == run.end()) {
    return Difference{theirs->time_ns,
                      begin + "the replay has one in " + text_of(*theirs) + ", the run none"};
  }
  return Difference{std::min(mine->time_ns, theirs->time_ns),
                    fmt::format("{}the run has one in {}, the replay one in {}", begin,
                                text_of(*mine), text_of(*theirs))};
}

}  // namespace

SpikeComparison compare_spikes(const std::string& run, const std::string& replay,
                               const std::vector<std::string>& nodes, TimeNs until) {
  namespace fs = std::filesystem;
  SpikeComparison result;
  std::optional<Difference> earliest;
  for (const std::string& node : nodes) {
    const std::string mine = (fs::path(run) / (node + ".h5")).string();
    const std::string theirs = (fs::path(replay) / (node + ".h5")).string();
    if (!fs::exists(mine)) {
      continue;  // a node that records nothing
    }
    if (!fs::exists(theirs)) {
      result.difference = fmt::format("node '{}' is in the run alone", node);
      return result;
    }
    for (const std::string& stream : record::read_info(mine).spikes) {
      const auto spikes = spikes_of(mine, stream, until);
      result.spikes += spikes.size();
      const auto difference = first_difference(node, spikes, spikes_of(theirs, stream, until));
      if (difference && (!earliest || difference->time < earliest->time)) {
        earliest = difference;
      }
    }
  }
  result.difference = earliest ? earliest->text : "";
  return result;
}

}  // namespace spikeloop::app
