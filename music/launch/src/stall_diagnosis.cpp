// Why a job does not go on.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "job_state.hpp"
#include "spikeloop/launch/effective_file.hpp"
#include "spikeloop/processes/process_tree.hpp"

namespace spikeloop::launch {
namespace {

using status::Phase;

/// Heartbeats come twice a second; a busy machine may hold some up.
constexpr std::chrono::seconds kSilence{3};
constexpr std::chrono::seconds kLastWord{1};
/// A foreign program is ahead of those that send to it by some ticks at most.
constexpr double kTicksAhead = 10;

std::string list(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

std::string JobState::shown(const std::string& label) const {
  return fmt::format("'{}' ({})", label, processes_.at(label).program);
}

bool JobState::one_waits(Clock::time_point now) const {
  return std::ranges::any_of(processes_, [&](const auto& entry) {
    const Process& process = entry.second;
    return process.ticked && process.phase == Phase::waiting && now - process.heard < kSilence &&
           (process.simulated_s == 0 || now - process.moved > kLastWord);
  });
}

std::string JobState::what_is_late(Clock::time_point now) const {
  constexpr std::array kWhat{"not started: ",
                             "silent: ",
                             "still preparing: ",
                             "started, but still without a first tick: ",
                             "waiting for the others: ",
                             "no news of: "};
  if (one_waits(now)) {
    return "";
  }
  std::array<std::vector<std::string>, kWhat.size()> labels;
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    if (process.program.empty() || process.ticked) {
      continue;
    }
    const bool silent = process.phase && now - process.heard > kSilence;
    const std::size_t kind = !process.started                     ? (process.ours ? 0 : 5)
                             : silent                             ? 1
                             : !process.phase                     ? 3
                             : *process.phase == Phase::preparing ? 2
                                                                  : 4;
    // A script that has raised waits for the others at the end of MPI, as if nothing had happened.
    labels.at(kind).push_back(shown(label) + (process.ours ? "" : last_line(label)));
  }
  std::vector<std::string> parts;
  for (std::size_t kind = 0; kind < kWhat.size(); ++kind) {
    if (!labels.at(kind).empty()) {
      parts.push_back(kWhat.at(kind) + list(labels.at(kind)));
    }
  }
  const bool all_expected_tick = parts.empty() || (parts.size() == 1 && !labels.back().empty());
  return all_expected_tick ? "" : fmt::format("{}", fmt::join(parts, "; "));
}

std::string JobState::why_nobody_starts(const std::map<std::string, bool>& living) const {
  std::vector<std::string> ended;
  std::vector<std::string> stopped;
  std::vector<std::string> foreign;
  std::vector<std::string> scripts;
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    if (process.program.empty()) {
      continue;
    }
    if (!living.contains(label)) {
      ended.push_back(shown(label));
    } else if (living.at(label)) {
      stopped.push_back(shown(label));
    } else if (!process.ours) {
      foreign.push_back(shown(label) + last_line(label));
    } else if (process.script) {
      scripts.push_back(shown(label));
    }
  }
  if (living.empty()) {
    return "mpirun has not started any program";
  }
  if (!ended.empty()) {
    return list(ended) + " has ended without MUSIC's Setup, where the others wait for it";
  }
  if (!stopped.empty()) {
    return list(stopped) + " has been stopped (SIGSTOP), and the others wait for it";
  }
  if (!foreign.empty()) {
    return "our programs wait in MUSIC's Setup, which these may not have called: " + list(foreign);
  }
  return scripts.empty()
             ? "all programs wait in MUSIC's Setup"
             : "programs wait in MUSIC's Setup, which these scripts call when they come "
               "to the host (spikeloop.music and its like): " +
                   list(scripts);
}

bool JobState::any_started() const {
  return std::ranges::any_of(processes_, [](const auto& entry) { return entry.second.started; });
}

std::string JobState::who_prepares(Clock::time_point now) const {
  std::vector<std::string> labels;
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    if (process.phase == Phase::preparing && now - process.heard < kSilence) {
      labels.push_back(shown(label));
    }
  }
  return list(labels);
}

std::vector<std::string> JobState::standing_still(Clock::duration longest,
                                                  Clock::time_point now) const {
  std::vector<std::string> labels;
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    const bool runs = !process.program.empty() && process.ticked && !process.reported;
    const bool waits_for_the_clock =
        process.phase == Phase::waiting && now - process.heard < kSilence;
    if (waits_for_the_clock && now - process.moved > longest / 2) {
      return {};  // long ticks, or a small real-time factor: the others wait for it
    }
    if (runs && now - process.left_wait < kLastWord) {
      return {};  // its patience may be over, and it says why in the next moment
    }
    if (runs && !waits_for_the_clock && now - process.moved > longest) {
      labels.push_back(label);
    }
  }
  return labels;
}

std::string JobState::who_stands_still(Clock::duration longest, Clock::time_point now) const {
  std::vector<std::string> silent;
  std::vector<std::string> computing;
  std::vector<std::string> ending;
  double earliest_s = INFINITY;
  if (standing_still(longest, now).empty()) {
    return "";
  }
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    const bool runs = !process.program.empty() && process.ticked && !process.reported;
    // Whoever holds up the others may have moved a little later than they.
    if (!runs || now - process.moved < longest / 2) {
      continue;
    }
    earliest_s = std::min(earliest_s, process.simulated_s);
    if (now - process.heard > kSilence) {
      silent.push_back(shown(label));
    } else if (process.phase == Phase::computing) {
      computing.push_back(shown(label));
    } else if (process.phase == Phase::finalizing) {
      ending.push_back(shown(label));
    }
  }
  std::string what;
  if (!silent.empty()) {
    what = list(silent) + " neither ticks nor answers: it is stopped, or hangs";
  } else if (!computing.empty()) {
    what = list(computing) + " does not come to the end of its step";
  } else if (!ending.empty()) {
    what = list(ending) + " has left its loop, but does not end";
  } else if (const auto foreign = without_news(); !foreign.empty()) {
    what = "our programs wait in MUSIC for " + list(foreign);
  } else {
    what = "all programs wait for each other in MUSIC";
  }
  return fmt::format("at {:g} s of simulated time: {}", earliest_s, what);
}

std::vector<std::string> JobState::without_news() const {
  std::vector<std::string> labels;
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    if (!process.program.empty() && !process.ours && !process.started) {
      labels.push_back(shown(label));
    }
  }
  return labels;
}

std::optional<Failure> JobState::first_death(
    const std::function<std::optional<int>(pid_t)>& end_of) const {
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    if (process.program.empty() || process.pid <= 1 || process.reported) {
      continue;
    }
    const auto status = end_of(process.pid);
    // mpirun ends the others by SIGTERM after a death: that is not the first one.
    const bool asked =
        process.terminated || (status && WIFSIGNALED(*status) && WTERMSIG(*status) == SIGTERM);
    if (!status || asked) {
      continue;
    }
    if (*status == -1) {
      return Failure{3, shown(label) + " has ended before its time" + last_line(label), false};
    }
    const int code = exit_code(*status);
    return Failure{std::max(1, code), WIFSIGNALED(*status)
                                          ? killed_text(shown(label), WTERMSIG(*status))
                                          : fmt::format("{} ended with exit code {}{}",
                                                        shown(label), code, last_line(label))};
  }
  return std::nullopt;
}

std::optional<double> JobState::left_before_s(const Process& process, const std::string& label,
                                              double end_s) const {
  if (!process.left || process.ours || process.reported) {
    return std::nullopt;
  }
  for (const MusicConnection& connection : file_.connections) {
    // Heard long enough after the end that its time is no older.
    const Process& sender = processes_.at(connection.from_app);
    if (connection.to_app == label && sender.ticked && !sender.reported &&
        sender.heard - *process.left > kLastWord && sender.simulated_s < end_s) {
      return sender.simulated_s;
    }
  }
  return std::nullopt;
}

std::string JobState::who_ended_early() const {
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    const MusicSection* section = file_.find_section(label);
    if (section == nullptr || !(process.reported || process.left)) {
      continue;
    }
    const auto end = stop_time(file_, *section);
    const double end_s = end ? to_seconds(*end) : INFINITY;
    const double tick_s = to_seconds(tick_of(file_, *section));
    // A program may tell of the begin of its last tick; and the times have been rounded.
    if (process.reported && process.simulated_s > 0 && process.simulated_s < end_s - 1.5 * tick_s) {
      return fmt::format("{} ended at {:g} s of simulated time, {}", shown(label),
                         process.simulated_s,
                         end ? fmt::format("before its stoptime of {:g} s", end_s)
                             : std::string("without being asked to"));
    }
    if (const auto before_s = left_before_s(process, label, end_s - kTicksAhead * tick_s)) {
      return fmt::format(
          "{} ended before {:g} s of simulated time, {}{}", shown(label), *before_s,
          end ? fmt::format("its stoptime is {:g} s; simulate as long as that", end_s)
              : std::string("without being asked to"),
          last_line(label));
    }
  }
  return "";
}

}  // namespace spikeloop::launch
