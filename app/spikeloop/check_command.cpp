#include "check_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "commands.hpp"
#include "diagnostic_text.hpp"
#include "experiment_command.hpp"
#include "output.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/launch/check.hpp"

namespace spikeloop::app::check_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop check braitenberg.music
  spikeloop check loop.music --strict     warnings are errors, too
  spikeloop check braitenberg.yaml        an experiment file: each error with its line
  spikeloop check --no-code brain.yaml    runs nothing that brain.yaml names

Starts no job and needs no ROS. Checks MUSIC's grammar, how the programs are connected, whether they
can be started, and lets each of our programs check its section, its keys and its files. The keys of
other people's programs are not judged. `spikeloop run` makes the same checks.

Loads the plug-ins that FILE names and runs its networks in Python (network: brain.py): both can do
whatever you can. For a stranger's file write --no-code: all else is checked, and what is not, told.

`spikeloop explain SL0103` explains the code at the end of an error.

Exit codes: 0 nothing wrong, 2 something is, 3 mpirun or music is missing, 4 a file cannot be read,
130 Ctrl-C)";

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
  put_result(summary_of(file));
  return 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  struct Arguments {
    std::string file;
    bool strict = false;
    bool no_code = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("check", "Say what is wrong with an experiment file or a .music file");
  command->add_option("FILE", arguments->file, "Experiment file or MUSIC configuration file")
      ->required();
  command->add_flag("--strict", arguments->strict, "Take warnings for errors");
  command->add_flag("--no-code", arguments->no_code, "Run no code that FILE names");
  command->footer(kFooter);
  command->callback([arguments, &action] {
    action = [arguments] {
      if (arguments->no_code) {
        ::setenv(kNoCode, "1", 1);
      }
      return is_experiment(arguments->file) ? check_experiment(arguments->file, arguments->strict)
                                            : check(arguments->file, arguments->strict);
    };
  });
}

}  // namespace spikeloop::app::check_command

namespace spikeloop::app {

int refuse(const Diagnostics& diagnostics, const std::string& file) {
  const Diagnostic first = first_error(diagnostics, file);
  put(stderr, fmt::format("spikeloop: {}\n", first.text()));
  return first.exit_code;
}

}  // namespace spikeloop::app
