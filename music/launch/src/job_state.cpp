#include "job_state.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <string.h>

#include <algorithm>
#include <type_traits>
#include <utility>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::launch {
namespace {

using nlohmann::json;

/// A clock lets the process tick more often than that.
constexpr std::chrono::seconds kLongWait{1};

/// Limit of processes that are not sections, such as the robot. Messages of further ones are
/// ignored.
constexpr std::size_t kMostOthers = 100;

/// What ssh's own messages begin with.
constexpr const char* kSsh = "ssh: ";

/// Nothing that a process sends may end the launcher.
template <typename T>
T value_of(const json& message, const char* key, T otherwise) {
  const auto found = message.find(key);
  if (found == message.end() || (std::is_integral_v<T> && !found->is_number_integer())) {
    return otherwise;
  }
  try {
    return found->get<T>();
  } catch (const json::exception&) {
    return otherwise;
  }
}

json object_of(const json& message, const char* key) {
  const auto found = message.find(key);
  return found != message.end() && found->is_object() ? *found : json::object();
}

bool waits_for_clock(const MusicFile& file, const MusicSection& section) {
  const MusicKey* key = file.find_key(section, "clock_master");
  return find_program(file, section) != nullptr && key != nullptr && key->value == "true";
}

}  // namespace

std::string killed_text(std::string_view who, int signal) {
  return fmt::format("{} was killed by signal {} ({})", who, signal, strsignal(signal));
}

JobState::JobState(const MusicFile& file, bool all_here) : file_(file) {
  for (const MusicSection& section : file.sections) {
    Process& process = processes_[section.label];
    process.program = what_runs(file, section);
    const Program* program = all_here ? find_program(file, section) : nullptr;
    process.ours = program != nullptr;
    process.script = program != nullptr && program->script;
    process.clock_master = waits_for_clock(file, section);
    if (process.clock_master && clock_master_.empty()) {
      clock_master_ = section.label;
    }
    order_.push_back(section.label);
  }
  progress_.total_s = total_time(file);
}

bool JobState::take(const json& message, Clock::time_point now) {
  const std::string type = message.at("type");
  if (type == "leaving") {
    const int rank = value_of(message, "rank", -1);
    const auto left = processes_.find(rank < 0 ? "" : label_of_rank(file_, rank));
    if (left != processes_.end()) {
      left->second.left = now;
    }
    return false;
  }
  const std::string label = message.at("process");
  if (!processes_.contains(label) && processes_.size() >= file_.sections.size() + kMostOthers) {
    return false;
  }
  Process& process = processes_[label];
  if (std::find(order_.begin(), order_.end(), label) == order_.end()) {
    order_.push_back(label);
  }
  process.heard = now;
  take_time(process, message, now);
  if (type == "started") {
    process.started = true;
    process.pid = value_of<pid_t>(message, "pid", 0);
  } else if (type == "first_tick") {
    process.ticked = true;
  } else if (type == "terminated") {
    process.terminated = true;
    terminated_ = terminated_.empty() ? label : terminated_;
  } else if (type == "alive") {
    take_phase(process, status::phase_named(value_of(message, "phase", std::string())), now);
  } else if (type == "progress") {
    process.ticked = true;
    return take_progress(label, message);
  } else if (type == "report") {
    process.ticked = process.reported = true;
    process.counters = object_of(message, "counters");
    process.summary = object_of(message, "summary");
    // The last message of progress may be lost, a report is not.
    return take_progress(label, message);
  } else if (type == "failure" && !failure_) {
    failure_ = {std::max(1, value_of(message, "exit_code", 1)),
                fmt::format("{}: {}", label, value_of(message, "message", std::string("failed")))};
  }
  return false;
}

/// Time for which the others had to wait for this one does not count.
void JobState::take_phase(Process& process, std::optional<status::Phase> phase,
                          Clock::time_point now) {
  const bool waits = phase == status::Phase::waiting;
  if (waits && now - process.moved > kLongWait) {
    for (auto& [label, other] : processes_) {
      other.moved = &other == &process ? other.moved : now;
    }
  }
  if (process.phase == status::Phase::waiting && !waits) {
    process.left_wait = process.moved = now;
  }
  process.phase = phase;
}

void JobState::take_time(Process& process, const json& message, Clock::time_point now) {
  const double before = process.simulated_s;
  // Threads of a process tell it: what is older may come later.
  process.simulated_s = std::max(before, value_of(message, "simulated_s", before));
  if (process.simulated_s != before || !process.ticked) {
    process.moved = now;
  }
}

bool JobState::take_progress(const std::string& label, const json& message) {
  Process& process = processes_[label];
  if (process.program.empty()) {
    return false;
  }
  const std::uint64_t before = process.overruns;
  if (process.clock_master) {  // each part of a job has one
    process.overruns = std::max(before, value_of(message, "overruns", before));
    progress_.overruns += process.overruns - before;
  }
  const bool by_clock_master = label == clock_master_;
  if (clock_master_heard_ && !by_clock_master) {
    return process.overruns != before;
  }
  clock_master_heard_ = clock_master_heard_ || by_clock_master;
  progress_.simulated_s = value_of(message, "simulated_s", progress_.simulated_s);
  progress_.wall_s = value_of(message, "wall_s", progress_.wall_s);
  return true;
}

void JobState::take(const OutputLine& line) {
  if (music_error_.empty() && line.text.find("Error in MUSIC library") != std::string::npos) {
    music_error_ = line.text;
  }
  if (line.rank) {
    if (line.error && !line.text.empty()) {
      error_tail_[*line.rank] = line.text;
    }
    return;
  }
  if (!aborted_ && line.text.find("(ompi_mpi_abort+") != std::string::npos) {
    aborted_ = line.speaker;
  }
  diagnosis_.read(line.text);
  // What ssh says of a host is the cause; Open MPI's guesses follow.
  const bool cause_known = last_line_of_mpirun_.starts_with(kSsh);
  const bool news = line.text.find_first_not_of("- ") != std::string::npos &&
                    line.text.find("Forwarding signal") == std::string::npos;
  if (!cause_known && news) {
    last_line_of_mpirun_ = line.text;
  }
}

std::vector<pid_t> JobState::pids() const {
  std::vector<pid_t> found;
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    if (!process.program.empty() && process.pid > 1) {
      found.push_back(process.pid);
    }
  }
  return found;
}

bool JobState::any_ticked() const {
  return std::any_of(processes_.begin(), processes_.end(), [](const auto& entry) {
    return !entry.second.program.empty() && entry.second.ticked;
  });
}

bool JobState::has_ticked(const std::string& label) const {
  const auto found = processes_.find(label);
  return found != processes_.end() && found->second.ticked;
}

void JobState::allow_for_pause(Clock::duration pause) {
  for (auto& [label, process] : processes_) {
    process.heard += pause;
    process.moved += pause;
    process.left_wait += pause;
    if (process.left) {
      *process.left += pause;
    }
  }
}

bool JobState::all_reported() const {
  bool any = false;
  for (const auto& [label, process] : processes_) {
    const bool expected = !process.program.empty() && (process.ours || process.started);
    if (expected && !process.reported) {
      return false;
    }
    any = any || expected;
  }
  return any;
}

std::optional<std::string> JobState::stood_at_end() const {
  for (const std::string& label : order_) {
    const json& summary = processes_.at(label).summary;
    if (summary.contains(status::kStoodAtEnd)) {
      return fmt::format("{}: {}", label, value_of(summary, status::kStoodAtEnd, std::string()));
    }
  }
  return std::nullopt;
}

std::vector<std::string> JobState::incomplete_files() const {
  std::vector<std::string> files;
  for (const std::string& label : order_) {
    const json& summary = processes_.at(label).summary;
    for (std::string& file : value_of(summary, "incomplete_files", std::vector<std::string>())) {
      if (std::ranges::find(files, file) == files.end()) {
        files.push_back(std::move(file));
      }
    }
  }
  return files;
}

std::optional<status::NoCommand> JobState::find_no_command() const {
  json counters = json::object();
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    // A section with one endpoint has its label; the nodes of an experiment have their own names.
    const bool has_node_names = process.program == "spikeloop-fused";
    for (const auto& [name, value] : process.counters.items()) {
      counters[has_node_names ? name
                              : label + name.substr(std::min(name.rfind('.'), name.size()))] =
          value;
    }
  }
  return status::find_no_command(counters);
}

std::string JobState::last_line(const std::string& label) const {
  const auto words = std::ranges::find_if(
      error_tail_, [&](const auto& entry) { return label_of_rank(file_, entry.first) == label; });
  return words == error_tail_.end() ? "" : kLastLine + words->second;
}

std::string JobState::named(int rank) const {
  const std::string label = label_of_rank(file_, rank);
  const auto process = processes_.find(label);
  return process == processes_.end() ? fmt::format("rank {}", rank) : shown(label);
}

Failure JobState::explain(const MpirunEnd& end) const {
  if (failure_) {
    return *failure_;
  }
  const int otherwise = end.exit_code == 0 ? 1 : end.exit_code;
  if (!music_error_.empty()) {
    return {diagnosis_.exit_code().value_or(otherwise), music_error_};
  }
  const auto rank = diagnosis_.rank() ? diagnosis_.rank() : aborted_;
  if (!rank && end.exit_code == 128 + SIGTERM && !terminated_.empty()) {
    return {end.exit_code, fmt::format("{} was ended by signal {} ({})", shown(terminated_),
                                       SIGTERM, strsignal(SIGTERM))};
  }
  if (!rank && end.killed) {
    return {otherwise, killed_text(end.program, end.exit_code - 128)};
  }
  if (!rank && !end.missed.empty()) {
    std::vector<std::string> names;
    names.reserve(end.missed.size());
    for (const std::string& label : end.missed) {
      names.push_back(shown(label));
    }
    const std::string who = fmt::format("{}", fmt::join(names, ", "));
    const int number = otherwise - 128;
    return {otherwise,
            number > 0 && number < NSIG
                ? killed_text(who, number)
                : fmt::format("{} ended before MUSIC's Setup, with exit code {}", who, otherwise)};
  }
  if (!rank && last_line_of_mpirun_.starts_with(kSsh)) {
    return {3, "a host of the job cannot be reached; " + last_line_of_mpirun_};
  }
  if (!rank) {
    return {otherwise,
            fmt::format(
                "{} ended with exit code {}{}", end.program, end.exit_code,
                last_line_of_mpirun_.empty() ? "" : "; its last line: " + last_line_of_mpirun_)};
  }
  const auto words = error_tail_.find(*rank);
  const std::string last = words == error_tail_.end() ? "" : kLastLine + words->second;
  if (const auto number = diagnosis_.signal()) {
    return {128 + *number, killed_text(named(*rank), *number) + last};
  }
  if (const auto code = aborted_ ? std::optional(otherwise) : diagnosis_.exit_code()) {
    return {*code, fmt::format("{} ended with exit code {}{}", named(*rank), *code, last)};
  }
  // mpirun's own code for it is 1, the program's was 0.
  return {3, fmt::format("{} ended without MUSIC's finalize{}", named(*rank), last)};
}

json JobState::summary() const {
  json result = json::object();
  json processes = json::object();
  for (const std::string& label : order_) {
    const Process& process = processes_.at(label);
    status::add_summary(process.summary, result);
    json& entry = processes[label];
    entry["reported"] = process.reported;
    entry["counters"] = process.counters;
    entry["summary"] = process.summary;
    if (!process.program.empty()) {
      entry["program"] = process.program;
    }
  }
  result["file"] = file_.path;
  result["simulated_s"] = progress_.simulated_s;
  result["wall_s"] = progress_.wall_s;
  result["real_time_factor"] = progress_.real_time_factor();
  result["overruns"] = progress_.overruns;
  result["processes"] = std::move(processes);
  return result;
}

}  // namespace spikeloop::launch
