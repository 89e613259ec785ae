#include "spikeloop/fused/run.hpp"
#include "spikeloop/core/file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "assembly.hpp"
#include "bag_transport.hpp"
#include "changes.hpp"
#include "file_watch.hpp"
#include "live_view.hpp"
#include "make_robot.hpp"
#include "memory_transport.hpp"
#include "run_summary.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/status/no_command.hpp"

namespace spikeloop::fused {
namespace {

using experiment::Experiment;
using experiment::Sync;
using nlohmann::json;

constexpr int kFileFault = 4;  // the exit code of a FileError
constexpr TimeNs kProgressPeriod = kNsPerSecond / 10;

void write_json(const std::string& path, const json& contents) {
  write_file(path, contents.dump(2) + "\n");
}

void copy_experiment(const Experiment& experiment, const std::string& folder) {
  namespace fs = std::filesystem;
  const fs::path copy = fs::path(folder) / kExperimentFile;
  std::error_code error;
  if (!fs::equivalent(experiment.path, copy, error)) {
    copy_to_new_file(experiment.path, copy.string());
  }
}

constexpr std::uintmax_t kLargestCopy = 100'000'000;  // bytes

/// A run is repeated with what it was made of, wherever its folder goes.
void copy_files(const Experiment& experiment, const std::string& folder) {
  namespace fs = std::filesystem;
  const std::string origin = fs::absolute(experiment.origin).lexically_normal().string();
  for (const std::string& file : experiment.files) {
    const std::string name = copy_of(file, origin);
    std::error_code error;
    if (name.empty() || fs::file_size(file, error) > kLargestCopy || error) {
      continue;
    }
    const fs::path copy = fs::path(folder) / kFilesFolder / name;
    fs::create_directories(copy.parent_path(), error);
    copy_to_new_file(file, copy.string());
  }
}

/// What nodes leave behind: learned weights.
void write_results(Graph& graph, const std::string& folder) {
  for (const Result& result : graph.results()) {
    write_weights(std::filesystem::path(folder) / result.file, result.table);
  }
}

std::unique_ptr<Pacer> make_pacer(const Experiment& experiment, const std::string& process,
                                  Transport& transport) {
  const bool waits = waits_for_clock(experiment, process);
  if (waits && experiment.sync == Sync::sim_time) {
    return transport.pacer();
  }
  return waits && experiment.sync == Sync::realtime
             ? make_realtime_pacer(experiment.real_time_factor, experiment.tick)
             : make_unpaced_pacer();
}

class Loop {
 public:
  Loop(const Experiment& experiment, const Surroundings& surroundings, Assembly& assembly,
       const RunOptions& options, const RunEvents& events)
      : experiment_(experiment),
        transport_(surroundings.transport),
        assembly_(assembly),
        others_(surroundings.others),
        view_(surroundings.view),
        events_(events),
        changes_(experiment, assembly.graph(), options.folder, *options.failures),
        files_(options, experiment.on_write_failure),
        pacer_(make_pacer(experiment, surroundings.process, transport_)) {}

  /// Whether there was a tick.
  bool tick() {
    Graph& graph = assembly_.graph();
    if (!begun_) {
      begin();
    }
    const robot::Episodes* const episodes = transport_.episodes();
    if (graph.time() >= experiment_.duration.value_or(kNever) || (episodes && episodes->over())) {
      return false;
    }
    if (view_ != nullptr) {
      view_->before_tick(graph.time(), changes_, events_);
    }
    changes_.repeat([this](const experiment::Change& change) {
      if (view_ != nullptr) {
        view_->show(change);
      }
    });
    pacer_->wait_until(graph.time());
    const TimeNs began = wall_now();
    transport_.begin(graph.time());
    if (events_.stop && events_.stop()) {
      return false;  // perhaps while it waited
    }
    graph.step();
    if (others_ != nullptr) {
      others_->exchange();
    }
    transport_.end(graph.time());
    reset_nodes();
    if (events_.ticked) {
      events_.ticked(graph.time());
    }
    const TimeNs now = wall_now();
    computing_ += now - began;
    tell_progress(now);
    files_.check(now);
    if (view_ != nullptr) {
      view_->after_tick(progress(), now);
    }
    return true;
  }

  /// Wall time of all ticks, without the waiting before them.
  TimeNs computing() const { return computing_; }

  void tell_progress(TimeNs now) {
    if (now >= next_ && events_.progress) {
      next_ = now + kProgressPeriod;
      events_.progress(progress());
    }
  }

  Progress progress() const {
    const auto report = pacer_->report();
    return {assembly_.graph().time(), report.wall_time, report.overruns};
  }

 private:
  void begin() {
    begun_ = true;
    if (others_ != nullptr) {
      others_->meet();
    }
    pacer_->start();
  }

  void reset_nodes() {
    const robot::Episodes* const episodes = transport_.episodes();
    if (!experiment_.episodes || episodes == nullptr || episodes->number() <= episode_) {
      return;
    }
    episode_ = episodes->number();
    for (const std::string& node : experiment_.episodes->reset) {
      assembly_.graph().reset(node);
    }
    if (!experiment_.episodes->reset.empty()) {
      std::ranges::for_each(assembly_.commands(),
                            [](auto* command) { command->sink().allow_no_value(); });
    }
  }

  const Experiment& experiment_;
  Transport& transport_;
  Assembly& assembly_;
  OtherProcesses* others_;
  LiveView* view_;
  const RunEvents& events_;
  Changes changes_;
  FileWatch files_;
  std::unique_ptr<Pacer> pacer_;
  bool begun_ = false;
  std::uint64_t episode_ = 1;
  TimeNs next_ = 0;
  TimeNs computing_ = 0;
};

/// What goes wrong first is the run's result.
template <typename Work>
void attempt(RunResult& result, Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    if (result.exit_code == 0) {
      result.exit_code = error.exit_code();
      result.reason = error.what();
    }
  }
}

}  // namespace

std::string copy_of(const std::string& file, const std::string& experiment_file) {
  namespace fs = std::filesystem;
  const std::string name =
      fs::path(file).lexically_relative(fs::path(experiment_file).parent_path()).string();
  return name.starts_with("..") || file == experiment_file ? "" : name;
}

std::unique_ptr<Transport> make_transport(const Experiment& experiment, const RunOptions& options) {
  const bool elsewhere =
      !options.process.empty() && !experiment::meets_robot(experiment, options.process);
  const auto robot = elsewhere ? std::nullopt : experiment.robot;
  if (robot && !robot->bag.empty()) {
    return std::make_unique<BagTransport>(experiment);
  }
  return std::make_unique<MemoryTransport>(
      robot ? make_robot(experiment, {.folder = options.folder,
                                      .spectators = options.spectators,
                                      .failures = options.failures.get()})
            : nullptr);
}

struct Run::Impl {
  Impl(const Experiment& run_experiment, Transport& transport, const RunOptions& run_options,
       const RunEvents& run_events, OtherProcesses* others)
      : experiment(run_experiment),
        options(run_options),
        events(run_events),
        surroundings{
            transport, others,
            options.process.empty() ? experiment.layout.processes.front().name : options.process},
        writes_files(!options.folder.empty() &&
                     surroundings.process == experiment.layout.processes.front().name) {
    if (writes_files) {
      write_begin();
    }
    if (!options.live_folder.empty()) {
      view.emplace(options.live_folder, experiment, surroundings.process);
      surroundings.view = &*view;
    }
    assembly.emplace(experiment, surroundings, options);
    transport.endpoints_added();
    if (view) {
      view->take_commands(assembly->commands());
      view->take_graph(assembly->graph());
      stop_button.emplace(view->feed(), assembly->commands());
    }
    loop.emplace(experiment, surroundings, *assembly, options, events);
  }

  void write_begin() const {
    json resolved = resolved_json(experiment);
    resolved["recorded"] = options.record;
    if (options.about.is_object()) {
      resolved.update(options.about);
    }
    write_json(options.folder + "/resolved.json", resolved);
    copy_experiment(experiment, options.folder);
    copy_files(experiment, options.folder);
  }

  void summarize() {
    const Progress progress = loop->progress();
    if (events.progress) {
      events.progress(progress);
    }
    if (view) {
      view->finish(progress);
    }
    attempt(result, [&] { surroundings.transport.finish(); });
    attempt(result,
            [&] { result.summary = summary_of(experiment, surroundings, *assembly, progress); });
    warn_of_silence(experiment, surroundings.transport, result.summary);
    warn_of_overruns(experiment, progress, loop->computing());
    std::string lost;
    result.summary.update(assembly->close_recordings(lost));
    if (!lost.empty() && result.exit_code == 0) {
      result.exit_code = kFileFault;
      result.reason = lost;
    }
    take_failures();
  }

  /// All files that are incomplete, whether the failure ended the run or not.
  void take_failures() {
    if (options.failures->any() && (result.exit_code == 0 || result.exit_code == kFileFault)) {
      result.exit_code = kFileFault;
      result.reason = options.failures->text();
    }
    if (options.failures->any()) {
      result.summary["incomplete_files"] = options.failures->files();
    }
  }

  /// The launcher judges a job of several processes.
  void judge_commands() {
    if (surroundings.others != nullptr || result.exit_code != 0 ||
        !result.summary.contains("counters")) {
      return;
    }
    const auto no_command = status::find_no_command(result.summary["counters"]);
    if (no_command && no_command->nothing_usable) {
      result.exit_code = UnusableMessages::kExitCode;
      result.reason = no_command->reason;
    } else if (no_command) {
      result.remark = no_command->reason;
    }
  }

  void write_end() {
    if (!options.folder.empty()) {
      attempt(result, [&] { write_results(assembly->graph(), options.folder); });
    }
    if (writes_files) {
      attempt(result, [&] { write_json(options.folder + "/summary.json", result.summary); });
    }
  }

  const Experiment& experiment;
  const RunOptions& options;
  const RunEvents& events;
  Surroundings surroundings;
  bool writes_files;
  std::optional<LiveView> view;
  std::optional<Assembly> assembly;
  std::optional<StopButton> stop_button;
  std::optional<Loop> loop;
  RunResult result{0, {}, json::object()};
};

Run::Run(const Experiment& experiment, Transport& transport, const RunOptions& options,
         const RunEvents& events, OtherProcesses* others)
    : impl_(std::make_unique<Impl>(experiment, transport, options, events, others)) {}

Run::~Run() = default;

bool Run::tick() {
  bool ticked = false;
  attempt(impl_->result, [&] { ticked = impl_->loop->tick(); });
  return ticked;
}

TimeNs Run::time() const {
  return impl_->assembly->graph().time();
}

RunResult Run::finish() {
  RunResult& result = impl_->result;
  impl_->assembly->stop_robot(result.exit_code == 0 ? command::StopReason::ended
                                                    : command::StopReason::terminated);
  impl_->summarize();
  if (impl_->events.ended) {
    impl_->events.ended(result);
  }
  impl_->judge_commands();
  if (impl_->options.process.empty()) {  // else the launcher writes the summary
    result.summary["file"] = experiment::file_of_user(impl_->experiment);
  }
  result.summary["exit_code"] = result.exit_code;
  const std::string finished =
      result.remark.empty() ? "finished" : fmt::format("finished; {}", result.remark);
  result.summary["exit_reason"] = result.exit_code == 0 ? finished : result.reason;
  impl_->write_end();
  return result;
}

RunResult run(const Experiment& experiment, const RunOptions& options, const RunEvents& events,
              OtherProcesses* others) {
  const auto transport = make_transport(experiment, options);
  return run(experiment, *transport, options, events, others);
}

RunResult run(const Experiment& experiment, Transport& transport, const RunOptions& options,
              const RunEvents& events, OtherProcesses* others) {
  Run run(experiment, transport, options, events, others);
  while (run.tick()) {
  }
  return run.finish();
}

}  // namespace spikeloop::fused
