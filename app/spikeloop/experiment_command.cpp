#include "experiment_command.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "experiment_folder.hpp"
#include "output.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/fused/run.hpp"

namespace spikeloop::app {
namespace {

using experiment::Experiment;
using experiment::Fault;

bool continues(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;  // inside a UTF-8 character
}

/// What stands around the place, when the line is too long for a screen. `at` counts bytes from 0.
std::string window(const std::string& line, std::size_t& at) {
  constexpr std::size_t kBefore = 60;
  constexpr std::size_t kLongest = 150;
  constexpr std::string_view kCut = "... ";
  if (line.size() <= kLongest || at > line.size()) {
    return line;
  }
  std::size_t begin = at > kBefore ? at - kBefore : 0;
  while (begin > 0 && continues(line[begin])) {
    --begin;
  }
  std::size_t end = std::min(line.size(), begin + kLongest);
  while (end < line.size() && continues(line[end])) {
    ++end;
  }
  at -= begin;
  at += begin > 0 ? kCut.size() : 0;
  return fmt::format("{}{}{}", begin > 0 ? kCut : "", line.substr(begin, end - begin),
                     end < line.size() ? " ..." : "");
}

/// The line of the file, and a caret below the place. YAML's columns count bytes.
std::string source_line(const Location& where) {
  if (where.line <= 0) {
    return "";
  }
  std::ifstream file(where.file);
  std::string line;
  for (int i = 0; i < where.line; ++i) {
    if (!std::getline(file, line)) {
      return "";
    }
  }
  line.erase(line.find_last_not_of("\r") + 1);
  std::size_t at = static_cast<std::size_t>(std::max(where.column, 1)) - 1;
  line = one_line(window(line, at));
  std::string text = fmt::format("{:>5} | {}\n", where.line, line);
  if (where.column > 0 && at <= line.size()) {
    const auto characters =
        std::count_if(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(at),
                      [](char c) { return !continues(c); });
    text += fmt::format("{:>{}}\n", "^", characters + 9);
  }
  return text;
}

std::string text_of(const char* kind, const Fault& fault) {
  return fmt::format("{}: {}\n{}", kind, fault.text, source_line(fault.where));
}

/// The experiment and all that it points to.
struct Loaded {
  experiment::Kinds kinds;
  std::vector<Fault> faults;
  std::optional<Experiment> experiment;
};

void load_plugins(const ExperimentFile& file, Loaded& loaded) {
  if (const char* directories = std::getenv("SPIKELOOP_PLUGIN_PATH"); directories != nullptr) {
    loaded.kinds.load_plugin_path(directories);
  }
  for (const WrittenValue& plugin : file.plugins) {
    try {
      located_at(plugin.where, [&] {
        const std::filesystem::path directory = experiment::directory_of(file.path);
        loaded.kinds.load_plugin((directory / plugin.text).string());
        return 0;
      });
    } catch (const Error& error) {
      loaded.faults.push_back({error.what(), error.where(), error.exit_code()});
    }
  }
}

void load(const std::string& path, const experiment::Overrides& overrides, Loaded& loaded) {
  try {
    const ExperimentFile file = read_experiment_file(path, [&](const ConfigurationError& error) {
      loaded.faults.push_back({error.what(), error.where(), error.exit_code()});
    });
    load_plugins(file, loaded);
    loaded.experiment = experiment::resolve(file, loaded.kinds, overrides, loaded.faults);
  } catch (const Error& error) {
    loaded.faults.push_back({error.what(), error.where(), error.exit_code()});
  }
}

std::atomic<int> signal_number{0};

/// The first one ends the loop, the second one the process.
void take_signal(int number) {
  if (signal_number.exchange(number) != 0) {
    ::_exit(128 + number);
  }
}

void take_signals() {
  struct sigaction action {};
  action.sa_handler = take_signal;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1}) {
    ::sigaction(number, &action, nullptr);
  }
}

launch::Progress for_console(const fused::Progress& progress, const Experiment& experiment) {
  launch::Progress shown{
      to_seconds(progress.simulated), to_seconds(progress.wall), {}, progress.overruns};
  if (experiment.duration) {
    shown.total_s = to_seconds(*experiment.duration);
  }
  return shown;
}

std::string count(std::size_t number, const char* what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

int run_loaded(const ExperimentArguments& arguments, const Experiment& experiment) {
  const ExperimentFolder folder(arguments.folder, experiment.name);
  const BackgroundOutput output;
  Console console(arguments.volume);
  log::set_sink(
      [&console](log::Level level, std::string_view message) { console.log(level, message); });
  take_signals();
  launch::Progress last;
  const fused::RunEvents events{.progress =
                                    [&](const fused::Progress& progress) {
                                      last = for_console(progress, experiment);
                                      console.progress(last);
                                    },
                                .stop = [] { return signal_number.load() != 0; }};
  const fused::RunResult result =
      fused::run(experiment, {.folder = folder.path(), .record = arguments.record}, events);
  log::set_sink({});
  launch::JobResult end{result.exit_code, result.reason, {}};
  if (const int number = signal_number.load(); number != 0 && result.exit_code == 0) {
    end.exit_code = 128 + number;
    end.reason = fmt::format("stopped by SIG{}", ::sigabbrev_np(number));
  }
  console.end(end, last);
  if (arguments.volume != Console::Volume::quiet) {
    put(stderr, fmt::format("spikeloop: run folder: {}\n", folder.shown()));
  }
  return end.exit_code;
}

}  // namespace

bool is_experiment(const std::string& file) {
  return file.ends_with(".yaml") || file.ends_with(".yml");
}

int run_experiment(const ExperimentArguments& arguments) {
  Loaded loaded;
  load(arguments.file, arguments.overrides, loaded);
  if (!loaded.faults.empty()) {
    put(stderr, text_of("spikeloop", loaded.faults.front()));
    if (loaded.faults.size() > 1) {
      put(stderr, fmt::format("spikeloop: {} more; see  spikeloop check {}\n",
                              count(loaded.faults.size() - 1, "error"), arguments.file));
    }
    return loaded.faults.front().exit_code;
  }
  return run_loaded(arguments, *loaded.experiment);
}

int use_experiment(const std::string& file, const std::function<int(const Experiment&)>& use) {
  Loaded loaded;
  load(file, {}, loaded);
  for (const Fault& fault : loaded.faults) {
    put(stderr, text_of("error", fault));
  }
  if (!loaded.faults.empty()) {
    put(stderr, fmt::format("spikeloop: {}: {}\n", file, count(loaded.faults.size(), "error")));
    return loaded.faults.front().exit_code;
  }
  return use(*loaded.experiment);
}

int check_experiment(const std::string& file) {
  return use_experiment(file, [&](const Experiment& experiment) {
    put_result(fmt::format(
        "{}: nothing to complain about: {}, {}, tick {}, {}\n", file,
        count(experiment.parts.size(), "node"), count(experiment.links.size(), "connection"),
        format_time(experiment.tick),
        experiment.duration ? format_time(*experiment.duration) : "runs until it is stopped"));
    return 0;
  });
}

}  // namespace spikeloop::app
