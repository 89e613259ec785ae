#include "experiment_command.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "diagnostic_text.hpp"
#include "experiment_places.hpp"
#include "output.hpp"
#include "recording_check.hpp"
#include "resources.hpp"
#include "ros2_look.hpp"
#include "ros_arguments.hpp"
#include "simulator_check.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/music_job.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/fused/robot_sensors.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/live/feed.hpp"
#include "spikeloop/processes/process_tree.hpp"
#include "spikeloop/status/signals.hpp"
#include "versions.hpp"

namespace spikeloop::app {
namespace {

/// Of `check --strict`: as if they were errors.
constexpr int kWarningsOnly = 2;

using experiment::Experiment;

std::atomic<int> signal_number{0};
std::atomic<int> log_file{-1};
constexpr unsigned kPatience_s = 3;

/// The first one ends the loop; the second one, or a node that hangs, the process.
void take_signal(int number) {
  if (signal_number.exchange(number) != 0) {
    ::_exit(128 + number);
  }
  ::alarm(kPatience_s);
}

void give_up(int /*alarm*/) {
  constexpr std::string_view kText =
      "spikeloop: a node has not come back within 3 s of the signal: the run is ended without a "
      "summary\n";
  for (const int file : {STDERR_FILENO, log_file.load()}) {
    [[maybe_unused]] const auto written = ::write(file, kText.data(), kText.size());
  }
  ::_exit(128 + signal_number.load());
}

void take_signals() {
  struct sigaction action {};
  action.sa_handler = take_signal;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1}) {
    if (!status::is_ignored(number)) {  // nohup, background jobs
      ::sigaction(number, &action, nullptr);
    }
  }
  action.sa_handler = give_up;
  ::sigaction(SIGALRM, &action, nullptr);
}

/// Whether a signal has come; then the loop is alive.
bool stop_asked() {
  if (signal_number.load() == 0) {
    return false;
  }
  ::alarm(0);
  return true;
}

launch::Progress for_console(const fused::Progress& progress, const Experiment& experiment) {
  launch::Progress shown{
      to_seconds(progress.simulated), to_seconds(progress.wall), {}, progress.overruns};
  if (experiment.duration) {
    shown.total_s = to_seconds(*experiment.duration);
  }
  return shown;
}

/// A run begins by removing what the run before left in its folder.
void refuse_own_recordings(const Experiment& experiment, const std::string& folder) {
  const auto refuse = [&](const Location& where, const char* key, const std::string& file) {
    namespace fs = std::filesystem;
    std::error_code error;
    if (fs::equivalent(fs::absolute(file).parent_path(), folder, error)) {
      throw ConfigurationError(
          where, with_code(Code::no_access,
                           "key '{}': the recording {} lies in the run folder, which a run "
                           "empties; give another folder with --out",
                           key, file));
    }
  };
  for (const experiment::Node& node : experiment.nodes) {
    if (node.kind == experiment::kSpikePlayback || node.kind == experiment::kSignalPlayback) {
      refuse(node.parameters.where("file"), "file", node.parameters.text("file"));
    }
  }
  if (experiment.robot && !experiment.robot->bag.empty()) {
    refuse(experiment.robot->where, "bag", experiment.robot->bag);
  }
}

/// Where there is no robot of ours, or one in a process that takes no options.
void refuse_spectators(const ExperimentArguments& arguments, const Experiment& experiment) {
  if (!arguments.spectators.any()) {
    return;
  }
  const char* name = arguments.spectators.window ? "--view" : "--render";
  if (!experiment.robot || !experiment.robot->bag.empty() || experiment.robot->environment) {
    throw ConfigurationError(fmt::format(
        "{} shows a simulated robot, and this experiment has none; leave it out", name));
  }
  if (experiment.ros == experiment::Ros::none && experiment::needs_music(experiment)) {
    throw ConfigurationError(fmt::format(
        "{} cannot show the robot beside simulators, or in a layout of several processes, without "
        "ROS; write  ros: 1  in the experiment, or leave it out",
        name));
  }
  arguments.spectators.options();  // what is wrong with them is said before there is a folder
}

std::optional<LiveServer> live_server(const LiveOptions& options, const Experiment& experiment,
                                      const launch::RunFolder& folder) {
  return options.on
             ? std::optional<LiveServer>(std::in_place, options, folder.path(), experiment.name)
             : std::nullopt;
}

launch::RunFolder folder_for(const ExperimentArguments& arguments, const Experiment& experiment) {
  return {arguments.folder, "runs/" + experiment.name, arguments.force};
}

/// What ends a run before it has begun is in its log, too.
template <typename Run>
int logged(RunLog& log, Run&& run) {
  try {
    return run();
  } catch (const Error& error) {
    log.write(fmt::format("{}; exit code {}", error.what(), error.exit_code()));
    throw;
  }
}

void begin_log(RunLog& log, const Experiment& experiment) {
  log.write(fmt::format("spikeloop {}: {}, layout {}, sync {}, seed {}", SPIKELOOP_VERSION,
                        experiment.path, name_of(experiment.layout),
                        experiment::name_of(experiment.sync), experiment.seed));
}

void say_which_signal(fused::RunResult& result) {
  if (const int number = signal_number.load(); number != 0 && result.exit_code == 0) {
    result.exit_code = 128 + number;
    result.reason = stopped_by(number);
  }
}

int run_here(const Experiment& experiment, const fused::RunOptions& options, Console::Volume volume,
             RunLog& log) {
  const BackgroundOutput output;
  Console console(volume, &log, experiment::follows_clock(experiment.sync));
  log::set_sink(
      [&console](log::Level level, std::string_view message) { console.log(level, message); });
  take_signals();
  launch::Progress last;
  const fused::RunEvents events{.ticked = [&log](TimeNs time) { log.at(to_seconds(time)); },
                                .progress =
                                    [&](const fused::Progress& progress) {
                                      last = for_console(progress, experiment);
                                      console.progress(last);
                                    },
                                .stop = stop_asked,
                                .ended = say_which_signal};
  const fused::RunResult result = fused::run(experiment, options, events);
  log::set_sink({});
  console.end({result.exit_code, result.reason, result.remark, {}}, last);
  return result.exit_code;
}

/// The robot that the experiment has, started when nobody publishes its topics.
void add_robot(const Experiment& experiment, const robot::SpectatorWords& spectators,
               launch::JobOptions& options) {
  if (!experiment.robot || experiment.ros == experiment::Ros::none) {
    return;
  }
  options.roscore = experiment.ros == experiment::Ros::ros1;
  options.robot = true;
  options.published_in_ros2 = published_in_ros2;
  if (const auto& model = experiment.robot->model) {
    options.robot_arguments = {fmt::format("--model={}", model->file),
                               fmt::format("--model-rate={}", model->rate_hz)};
    if (!model->keyframe.empty()) {
      options.robot_arguments.push_back(fmt::format("--keyframe={}", model->keyframe));
    }
  } else {
    options.robot_arguments = {fmt::format("--world={}", experiment.robot->world),
                               fmt::format("--seed={}", experiment.robot->seed)};
  }
  const auto add = [&](const std::vector<std::string>& more) {
    options.robot_arguments.insert(options.robot_arguments.end(), more.begin(), more.end());
  };
  if (const auto& camera = experiment.robot->camera) {
    add({fmt::format("--camera={}x{}", camera->width, camera->height),
         fmt::format("--camera-name={}", camera->name),
         fmt::format("--camera-rate={}", camera->rate_hz),
         fmt::format("--camera-fov={}", camera->field_of_view_deg)});
  }
  add(spectators.arguments());
  if (experiment.sync == experiment::Sync::lockstep) {
    options.robot_arguments.emplace_back("--step");
  } else if (experiment.sync == experiment::Sync::sim_time) {
    // A clock that is slower than the ticks would bring them in bursts.
    const double rate = std::clamp(1 / to_seconds(experiment.tick), 100.0, 1000.0);
    options.robot_arguments.push_back(fmt::format("--clock-rate={}", rate));
  }
}

launch::JobOptions job_options(const ExperimentArguments& arguments, const Experiment& experiment,
                               const std::string& folder) {
  launch::JobOptions options;
  options.folder = folder;
  options.source = experiment::file_of_user(experiment);
  options.start_timeout = arguments.start_timeout;
  options.stall_timeout = arguments.stall_timeout;
  add_robot(experiment, arguments.spectators, options);
  add_ros_arguments(arguments.line.ros, options);
  return options;
}

/// A job that lies in its run folder.
int run_music_job(const ExperimentArguments& arguments, const Experiment& experiment,
                  const launch::RunFolder& folder, const WrittenJob& music) {
  RunLog log(folder.path());
  begin_log(log, experiment);
  launch::JobOptions options = job_options(arguments, experiment, folder.path());
  options.translate = music.places;
  options.alone = !experiment::needs_music(experiment);
  const int exit_code = logged(log, [&] {
    launch::Job job(read_music_file(music.path), options);
    require_resources(
        needs_of(job.effective().file, options, !live::folder_from_environment().empty(),
                 [&](const std::string& process) { return meets_robot(experiment, process); }));
    return run_job(job, arguments.volume, &log, experiment::follows_clock(experiment.sync));
  });
  put_result(folder.shown() + "\n");
  return exit_code;
}

/// Number of DDS participants that an experiment needs, including guard and simulated robot.
std::size_t participants_of(const Experiment& experiment) {
  if (experiment.ros != experiment::Ros::ros2) {
    return 0;
  }
  const auto& processes = experiment.layout.processes;
  const auto count = static_cast<std::size_t>(std::ranges::count_if(
      processes, [&](const auto& process) { return meets_robot(experiment, process.name); }));
  const bool guard = std::ranges::any_of(
      experiment.nodes, [](const auto& node) { return node.kind == experiment::kRosCommand; });
  return count + (guard ? 1 : 0) + (experiment.robot ? 1 : 0);
}

/// What is wrong with the file comes first.
std::unique_ptr<experiment::Loaded> load_with_simulators(const std::string& file,
                                                         const experiment::Overrides& overrides) {
  auto loaded = experiment::load(file, overrides, fused::look_at_robot);
  if (loaded->diagnostics.empty()) {
    check_simulators(*loaded->experiment, loaded->diagnostics);
  }
  return loaded;
}

/// Episodes that end a run, or begin a node anew, would have to tell other processes. Python,
/// which can stand for a simulator, is none.
void refuse_episodes_of_several_processes(const Experiment& experiment) {
  const auto& episodes = experiment.episodes;
  if (episodes && (episodes->count || !episodes->reset.empty()) &&
      experiment::needs_music(experiment)) {
    throw ConfigurationError(
        experiment.robot->where,
        with_code(Code::conflicting_keys,
                  "key 'episodes': count and reset are for a run of one process, and this one has "
                  "several; leave them out, and write a duration"));
  }
}

/// What MUSIC asks of an experiment in several processes.
void check_layout(experiment::Loaded& loaded) {
  if (!loaded.diagnostics.empty()) {
    return;
  }
  const Experiment& experiment = *loaded.experiment;
  try {
    if (experiment::needs_music(experiment)) {
      experiment::process_job(experiment::with_layout_delays(experiment), "", {});
    }
  } catch (const Error& error) {
    loaded.diagnostics.push_back(diagnostic_of(error));
  }
}

}  // namespace

bool is_experiment(const std::string& file) {
  return file.ends_with(".yaml") || file.ends_with(".yml");
}

int run_in_process(const Experiment& experiment, const launch::RunFolder& folder, bool record,
                   Console::Volume volume, const robot::SpectatorOptions& spectators) {
  RunLog log(folder.path());
  log_file.store(log.descriptor());
  begin_log(log, experiment);
  const fused::RunOptions options{.folder = folder.path(),
                                  .record = record,
                                  .spectators = spectators,
                                  .about = about_run(partners_of(experiment)),
                                  .live_folder = live::folder_from_environment()};
  const int exit_code = logged(log, [&] { return run_here(experiment, options, volume, log); });
  log_file.store(-1);
  put_result(folder.shown() + "\n");
  return exit_code;
}

std::unique_ptr<experiment::Loaded> load_experiment(const std::string& file,
                                                    const experiment::Overrides& overrides) {
  auto loaded = load_with_simulators(file, overrides);
  if (!loaded->diagnostics.empty()) {
    put(stderr, text_of("spikeloop", loaded->diagnostics.front()));
    if (loaded->diagnostics.size() > 1) {
      put(stderr, fmt::format("spikeloop: {} more; see  spikeloop check {}\n",
                              count_of(loaded->diagnostics.size() - 1, "error"), file));
    }
  }
  return loaded;
}

int run_experiment(const ExperimentArguments& arguments) {
  const auto all = load_experiment(arguments.file, arguments.overrides);
  experiment::Loaded& loaded = *all;
  if (!loaded.diagnostics.empty()) {
    return loaded.diagnostics.front().exit_code;
  }
  const Experiment& experiment = *loaded.experiment;
  if (arguments.line.use_sim_time.value_or(false) && experiment.ros != experiment::Ros::none &&
      experiment.sync == experiment::Sync::realtime) {
    ExperimentArguments by_clock = arguments;
    by_clock.overrides.settings.push_back({"sync", "sim_time", "use_sim_time"});
    return run_experiment(by_clock);
  }
  refuse_own_recordings(experiment, arguments.folder);
  refuse_spectators(arguments, experiment);
  check_ros_arguments(arguments.line, versions_of(experiment),
                      experiment::one_meets_robot(experiment));
  check_layout(loaded);  // what cannot be is refused before there is a folder
  if (!loaded.diagnostics.empty()) {
    put(stderr, text_of("spikeloop", loaded.diagnostics.front()));
    return loaded.diagnostics.front().exit_code;
  }
  if (experiment::needs_music(experiment) || experiment.ros != experiment::Ros::none) {
    const launch::RunFolder folder = folder_for(arguments, experiment);
    const auto live = live_server(arguments.live, experiment, folder);
    return run_processes(arguments, experiment, folder);
  }
  if (!arguments.timeout_given.empty()) {
    throw ConfigurationError(fmt::format(
        "{} is for runs in several processes (layout,  ros,  a simulator), and this one "
        "has a single process; leave it out",
        arguments.timeout_given));
  }
  if (arguments.live.on) {
    require_resources({.mpi = false, .feeds = 1});
  }
  const launch::RunFolder folder = folder_for(arguments, experiment);
  const auto live = live_server(arguments.live, experiment, folder);
  return run_in_process(experiment, folder, arguments.record, arguments.volume,
                        arguments.spectators.options());
}

int run_processes(const ExperimentArguments& arguments, const Experiment& written,
                  const launch::RunFolder& folder) {
  const Experiment experiment = experiment::with_layout_delays(written);
  std::map<std::string, std::string> keys{
      {"about", about_run(partners_of(experiment)).dump()},
      {"record", arguments.record ? "true" : "false"},
      {"stall_timeout",
       fmt::format("{}", std::chrono::duration<double>(arguments.stall_timeout).count())},
      {"start_timeout",
       fmt::format("{}", std::chrono::duration<double>(arguments.start_timeout).count())}};
  if (!arguments.overrides.origin.empty()) {
    keys["origin"] = std::filesystem::absolute(arguments.overrides.origin).string();
  }
  if (!arguments.overrides.changes.empty()) {
    keys["changes"] = std::filesystem::absolute(arguments.overrides.changes).string();
  }
  if (const auto& replay = arguments.overrides.replay) {
    keys["replay_bag"] = replay->bag.empty() ? "" : std::filesystem::absolute(replay->bag).string();
  }
  refuse_episodes_of_several_processes(experiment);
  const WrittenJob music =
      write_job(experiment::process_job(experiment, folder.path(), keys), folder.path());
  return run_music_job(arguments, experiment, folder, music);
}

WrittenJob write_music_job(const Experiment& experiment, const std::string& folder) {
  const std::string whole = std::filesystem::absolute(folder).lexically_normal().string();
  const auto job = experiment::music_job(experiment, whole);  // may be refused
  return write_job(job, launch::make_folder(whole));
}

WrittenJob write_job(const experiment::MusicJob& job, const std::string& folder) {
  for (const auto& [name, contents] : job.files) {
    write_file(folder + "/" + name, contents);
  }
  const std::string path = folder + "/experiment.music";
  write_file(path, to_text(job.file));
  return {path, places_of(read_music_file(path), job.file)};
}

int use_experiment(const std::string& file, const std::function<int(const Experiment&)>& use) {
  const auto loaded = load_with_simulators(file, {});
  if (loaded->diagnostics.empty()) {
    return use(*loaded->experiment);
  }
  const int exit_code = print_diagnostics(file, loaded->diagnostics);
  if (exit_code != 0) {
    return exit_code;
  }
  put(stderr,
      fmt::format("spikeloop: {} is not processed: it needs Python code, which --no-code does not "
                  "run; leave out --no-code if you trust the file\n",
                  file));
  return kWarningsOnly;
}

/// Returns the exit code.
int report_recording(const Experiment& experiment, bool strict) {
  if (!experiment.robot || experiment.robot->bag.empty()) {
    return 0;
  }
  const RecordingCheck check = check_recording(experiment);
  const TimeNs length = experiment.duration.value_or(check.checked);
  if (check.checked < length && !has_errors(check.diagnostics)) {
    put(stderr, fmt::format("spikeloop: {}: the first {} of {} of the recording were checked\n",
                            experiment.path, format_time(check.checked), format_time(length)));
  }
  if (check.diagnostics.empty()) {
    return 0;
  }
  const int exit_code = print_diagnostics(experiment.path, check.diagnostics);
  return exit_code == 0 && strict ? kWarningsOnly : exit_code;
}

int check_experiment(const std::string& file, const Settings& settings,
                     const CheckOptions& options) {
  const auto loaded = load_with_simulators(file, {.settings = settings});
  check_layout(*loaded);
  if (!options.json && loaded->diagnostics.empty()) {
    refuse_episodes_of_several_processes(*loaded->experiment);
  }
  if (!loaded->diagnostics.empty()) {
    const int exit_code = print_diagnostics(file, loaded->diagnostics);
    return exit_code == 0 && options.strict ? kWarningsOnly : exit_code;
  }
  const Experiment& experiment = *loaded->experiment;
  if (const int exit_code = report_recording(experiment, options.strict); exit_code != 0) {
    return exit_code;
  }
  if (options.json) {
    put_result(fused::resolved_json(experiment::with_layout_delays(experiment)).dump(2) + "\n");
    return 0;
  }
  warn_of_participants(participants_of(experiment));
  const auto& episodes = experiment.episodes;
  const std::string length = experiment.duration           ? format_time(*experiment.duration)
                             : episodes && episodes->count ? count_of(*episodes->count, "episode")
                                                           : "runs until it is stopped";
  put_result(fmt::format(
      "{}: OK: {}, {}, tick {}, {}\n", file, count_of(experiment.nodes.size(), "node"),
      count_of(experiment.connections.size(), "connection"), format_time(experiment.tick), length));
  return 0;
}

}  // namespace spikeloop::app
