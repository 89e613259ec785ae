#include "check_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "diagnostic_text.hpp"
#include "experiment_command.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "resources.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/launch/check.hpp"

namespace spikeloop::app::check_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop check braitenberg.music
  spikeloop check loop.music --strict     warnings are errors
  spikeloop check braitenberg.yaml        every error of an experiment file with its line
  spikeloop check braitenberg.yaml --set layout=separate
  spikeloop check --no-code brain.yaml    runs no code that brain.yaml names

Checks the MUSIC grammar, the connections of the programs, and whether they can be started. Each
Spikeloop program checks its section, keys and files. The keys of other programs are not checked.
Starts no job and needs no ROS. `spikeloop run` makes the same checks. The messages of a recording
(robot: {bag: PATH}) are passed to the sensors for at most 4 s, to report what the run would report.

Loads the plug-ins that FILE names and runs its networks in Python (network: brain.py), with your
permissions. Use --no-code for an untrusted file; it reports what it does not check.

`spikeloop explain SL0103` explains the code at the end of an error.

Exit codes: 0 no errors, 2 errors, 3 mpirun or music is missing, 4 a file cannot be read,
7 no message of a recording is usable, 130 Ctrl-C)";

std::string summary_of(const MusicFile& file) {
  const auto& first = file.sections.front();
  const auto length = launch::total_time(file);
  return fmt::format(
      "{}: OK: {}, {}, tick {}, {}\n", file.path, count_of(file.sections.size(), "program"),
      count_of(file.connections.size(), "connection"), format_time(launch::tick_of(file, first)),
      length ? fmt::format("{:g} s", *length) : std::string("runs until it is stopped"));
}

int check(const std::string& path, bool strict) {
  const MusicFile file = read_music_file(path);
  launch::RunOptions options;
  options.strict = strict;
  const Diagnostics diagnostics = launch::check_job(file, options);
  if (!diagnostics.empty() && diagnostics.front().exit_code > 128) {
    put(stderr, fmt::format("spikeloop: {}\n", diagnostics.front().text()));
    return diagnostics.front().exit_code;
  }
  if (!diagnostics.empty()) {
    return print_diagnostics(path, diagnostics);
  }
  warn_of_participants(
      needs_of(file, {}, false, [](const std::string&) { return true; }).participants);
  put_result(summary_of(file));
  return 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  struct Arguments {
    std::string file;
    bool strict = false;
    bool json = false;
    std::vector<std::string> settings;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("check", "Report errors in an experiment file or a .music file");
  command->add_option("FILE", arguments->file, "Experiment file or MUSIC configuration file")
      ->required();
  command->add_flag("--strict", arguments->strict, "Treat warnings as errors");
  add_settings(*command, arguments->settings);
  command->add_flag("--json", arguments->json,
                    "Print the experiment with every default, width and delay");
  add_no_code(*command);
  command->footer(kFooter);
  command->callback([arguments, &action] {
    action = [arguments] {
      const Settings settings = parse_settings(arguments->settings);
      if (is_experiment(arguments->file)) {
        return check_experiment(arguments->file, settings,
                                {.strict = arguments->strict, .json = arguments->json});
      }
      refuse_script(arguments->file);
      require_regular_file(arguments->file, "experiment");
      if (arguments->json || !settings.empty()) {
        throw ConfigurationError(fmt::format("{} is for experiment files; leave it out",
                                             arguments->json ? "--json" : "--set"));
      }
      return check(arguments->file, arguments->strict);
    };
  });
}

}  // namespace spikeloop::app::check_command

namespace spikeloop::app {

void refuse_script(const std::string& file) {
  if (file.ends_with(".py")) {
    throw ConfigurationError(with_code(
        Code::wrong_shape,
        "'{0}' is a script, not an experiment; write in an experiment  brain: {{simulator: python, "
        "script: {0}}},  or  network: {0}:FUNCTION",
        file));
  }
}

int refuse(const Diagnostics& diagnostics, const std::string& file) {
  const Diagnostic first = first_error(diagnostics, file);
  put(stderr, fmt::format("spikeloop: {}\n", first.text()));
  return first.exit_code;
}

}  // namespace spikeloop::app
