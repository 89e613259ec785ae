// The program `spikeloop`: runs closed loops between robots and spiking neural networks.
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "output.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/live/feed.hpp"
#include "spikeloop/processes/home.hpp"
#include "spikeloop/topics/arguments.hpp"

namespace {

constexpr int kUsageError = 2;

int fail(const std::string& message, int exit_code) {
  spikeloop::app::put(stderr, fmt::format("spikeloop: {}\n", message));
  return exit_code;
}

/// The first argument is neither an option nor a command; empty when all is well.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(command->get_name());
  }
  if (word.empty() || word.front() == '-' ||
      std::find(known.begin(), known.end(), word) != known.end()) {
    return "";
  }
  if (word.ends_with(".music")) {
    return fmt::format("'{0}' is a file, not a command; write: spikeloop run {0}", word);
  }
  return fmt::format("unknown command '{}'{}", word, spikeloop::did_you_mean(word, known));
}

/// "see spikeloop run --help" for the command that was given.
std::string see_help(const CLI::App& app) {
  const auto given = app.get_subcommands();
  return fmt::format("see spikeloop {}--help",
                     given.empty() ? "" : given.front()->get_name() + " ");
}

/// With "did you mean" for an option.
std::string unexpected(const CLI::App& app) {
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands()) {
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) {
        known.push_back("--" + name);
      }
    }
  }
  const auto rest = app.remaining(true);
  const std::string word = rest.empty() ? "" : rest.front().substr(0, rest.front().find('='));
  const std::string suggestion = spikeloop::nearest(word, known);
  return fmt::format(
      "{} '{}'; {}", word.starts_with('-') ? "unknown option" : "unexpected argument", word,
      suggestion.empty() ? see_help(app) : fmt::format("did you mean '{}'?", suggestion));
}

/// A run takes names as a node of ROS does, from anywhere on its line.
spikeloop::topics::CommandLine split(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "run") {
    return spikeloop::topics::split_command_line(argc, argv);
  }
  return {.own = {argv, argv + argc}, .ros = {}, .foreign = {}, .use_sim_time = {}};
}

/// Else our first files would take these numbers, and what is printed would go into them.
void open_standard_files() {
  for (int fd = 0; fd <= 2; ++fd) {
    if (fcntl(fd, F_GETFD) < 0) {
      open("/dev/null", O_RDWR);
    }
  }
}

int run(int argc, char** argv) {
  using namespace spikeloop::app;
  CLI::App app("Spikeloop: closed loops between robots and spiking neural networks", "spikeloop");
  app.set_version_flag("--version", "spikeloop " SPIKELOOP_VERSION);
  app.require_subcommand(1);
  Action action;
  const spikeloop::topics::CommandLine line = split(argc, argv);
  new_command::add(app, action);
  run_command::add(app, line, action);
  sweep_command::add(app, action);
  replay_command::add(app, action);
  check_command::add(app, action);
  export_command::add(app, action);
  import_command::add(app, action);
  view_command::add(app, action);
  plot_command::add(app, action);
  summary_command::add(app, action);
  fit_command::add(app, action);
  bench_command::add(app, action);
  describe_command::add(app, action);
  explain_command::add(app, action);
  doctor_command::add(app, action);
  completion_command::add(app, action);
  schema_command::add(app, action);
  graph_command::add(app, action);
  if (argc == 1) {
    put(stdout, app.help());
    return 0;
  }
  if (const std::string message = unknown_command(app, argc, argv); !message.empty()) {
    return fail(message, kUsageError);
  }
  try {
    // Without the program's name, the last word first.
    app.parse(std::vector<std::string>(line.own.rbegin(), line.own.rend() - 1));
  } catch (const CLI::ExtrasError&) {
    return fail(unexpected(app), kUsageError);
  } catch (const CLI::Success& wanted) {
    return app.exit(wanted);
  } catch (const CLI::ParseError& error) {
    return fail(fmt::format("{}; {}", error.what(), see_help(app)), kUsageError);
  }
  return action();
}

}  // namespace

int main(int argc, char** argv) {
  // Whoever reads our output may stop reading: that must not end a job without stopping it.
  signal(SIGPIPE, SIG_IGN);
  open_standard_files();
  // Of a run that we were started in: ours is another one.
  unsetenv("_MUSIC_CONFIG_");
  unsetenv(spikeloop::live::kFolderVariable);
  spikeloop::provide_home();
  try {
    return run(argc, argv);
  } catch (const spikeloop::Error& error) {
    return fail(error.what(), error.exit_code());
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}
