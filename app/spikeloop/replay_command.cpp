#include "commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "experiment_command.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "recorded_run.hpp"
#include "spike_comparison.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/fused/run.hpp"

namespace spikeloop::app::replay_command {
namespace {

namespace fs = std::filesystem;

constexpr int kDifferent = 6;

constexpr const char* kFooter = R"(Examples:
  spikeloop replay runs/explorer-1                 writes runs/explorer-1-replay-1
  spikeloop replay runs/explorer-1 --out again

Runs the experiment of a run folder again, as fast as possible, for the same simulated time. The
messages.mcap of the folder replaces robot and ROS. Then all recorded spikes are compared. The
experiment and its files are the copies in the folder; warnings list originals that have changed.
'spikeloop run RUN' repeats the run itself, with its robot.

Exit codes:
  0  the same spikes       6  different spikes
  2  the folder cannot be replayed           4  a file cannot be read or written
  5  a node failed         129, 130, 131, 138, 143  stopped, as in 'spikeloop run')";

struct Arguments {
  std::string run;
  std::string folder;
  bool force = false;
  bool quiet = false;
};

/// "12,345"
std::string with_commas(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<std::size_t>(at), ",");
  }
  return text;
}

void warn(const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    put(stderr, fmt::format("spikeloop: warning: {}\n", text));
  }
}

std::vector<std::string> names_of(const nlohmann::json& nodes) {
  std::vector<std::string> names;
  for (const auto& [name, keys] : nodes.items()) {
    names.push_back(name);
  }
  return names;
}

int compare(const RecordedRun& run, const launch::RunFolder& folder) {
  const SpikeComparison result = compare_spikes(
      run.folder, folder.path(), names_of(run.resolved["nodes"]), from_seconds(run.simulated_s));
  if (!result.difference.empty()) {
    put_result(fmt::format("spikeloop: {}\n", result.difference));
    return kDifferent;
  }
  if (result.spikes == 0) {
    put_result("spikeloop: no spikes were recorded; nothing was compared\n");
    return 0;
  }
  put_result(
      fmt::format("spikeloop: {} spikes: the same in both runs\n", with_commas(result.spikes)));
  return 0;
}

/// As it was written, but a new folder beside it can be named after it.
std::string folder_name(const std::string& written) {
  const fs::path folder = fs::path(written + "/").lexically_normal().parent_path();
  const fs::path name = folder.filename();
  std::error_code error;
  return name.empty() || name == "." || name == ".." ? fs::weakly_canonical(written, error).string()
                                                     : folder.string();
}

int replay(const Arguments& arguments) {
  const std::string folder = folder_name(arguments.run);
  const RecordedRun run = read_recorded_run(folder);
  refuse_own_folder(arguments.folder, folder);
  warn(doubts(run));
  ExperimentArguments once_more;
  once_more.file = run.experiment_file;
  once_more.overrides.settings = run.settings;
  once_more.overrides.origin = run.origin;
  once_more.overrides.replay = run.replay;
  once_more.overrides.changes = run.changes;
  once_more.volume = arguments.quiet ? Console::Volume::quiet : Console::Volume::normal;
  const auto loaded = load_experiment(run.experiment_file, once_more.overrides);
  if (!loaded->diagnostics.empty()) {
    return loaded->diagnostics.front().exit_code;
  }
  const experiment::Experiment experiment = experiment::with_layout_delays(*loaded->experiment);
  warn(doubts(run, fused::resolved_json(experiment)));
  const launch::RunFolder made(arguments.folder, folder + "-replay", arguments.force);
  const int exit_code = experiment::needs_music(experiment)
                            ? run_processes(once_more, experiment, made)
                            : run_in_process(experiment, made, true, once_more.volume);
  return exit_code == 0 ? compare(run, made) : exit_code;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "replay", "Repeat a run with its recorded messages and compare the spikes");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("RUN", arguments->run, "Run folder of an experiment")
      ->required()
      ->check(named("run folder"));
  command->add_option("--out", arguments->folder, "Run folder of the replay [RUN-replay-N]")
      ->check(named("folder"));
  command->add_flag("--force", arguments->force, "Replace the results of a run in that folder");
  command->add_flag("-q,--quiet", arguments->quiet, "Print only the result, warnings and errors");
  command->footer(kFooter);
  command->callback([arguments, &action] { action = [arguments] { return replay(*arguments); }; });
}

}  // namespace spikeloop::app::replay_command
