#include "../commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "../diagnostic_text.hpp"
#include "../experiment_command.hpp"
#include "../option_values.hpp"
#include "../output.hpp"
#include "music_import.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/log.hpp"

namespace spikeloop::app::import_command {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Examples:
  spikeloop import loop.music --out loop.yaml && spikeloop run loop.yaml
  spikeloop import braitenberg.music --robot > robot.yaml

Writes a node for every section, with the keys and defaults of its program, and a line for every
connection, with the delays of a MUSIC job. With the same recorded input the experiment gives the
job's spikes. Paths are relative to the folder of --out, by default to the current folder. Parts
that an experiment cannot have are reported with their place, and written to the file as comments.

Exit codes: 0 everything is imported, 1 parts are left out, 2 the file is invalid,
4 a file cannot be read or written)";

constexpr int kIncomplete = 1;

struct ImportArguments {
  std::string file;
  std::string out;
  bool robot = false;
};

void tell(const char* kind, const Diagnostics& list) {
  for (const Diagnostic& found : list) {
    put(stderr, text_of(kind, found));
  }
}

void check(const ImportArguments& given) {
  if (is_experiment(given.file)) {
    throw ConfigurationError(
        fmt::format("'{0}' is an experiment already; write  spikeloop run {0}", given.file));
  }
  if (!given.out.empty() && !is_experiment(given.out)) {
    throw ConfigurationError(
        fmt::format("--out: '{}' is not a valid experiment file name; write one that ends in .yaml",
                    given.out));
  }
}

int import_file(const ImportArguments& given) {
  check(given);
  log::set_sink([](log::Level /*level*/, std::string_view message) {
    put(stderr, fmt::format("warning: {}\n", message));
  });
  const fs::path folder = fs::absolute(given.out.empty() ? "x" : given.out).parent_path();
  const Imported imported = import_music(read_music_file(given.file), {folder, given.robot});
  log::set_sink({});
  if (given.out.empty()) {
    put_result(imported.text);
  } else {
    write_file(given.out, imported.text);
  }
  tell("warning", imported.notes);
  tell("error", imported.errors);
  if (imported.errors.empty()) {
    return 0;
  }
  put(stderr, fmt::format("spikeloop: {}: {}; the experiment is not complete\n", given.file,
                          count_of(imported.errors.size(), "error")));
  return kIncomplete;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto given = std::make_shared<ImportArguments>();
  CLI::App* command = app.add_subcommand("import", "Convert a .music file to an experiment");
  command->add_option("FILE", given->file, "MUSIC configuration file")->required();
  command->add_option("--out", given->out, "Experiment file [standard output]")
      ->check(named("file"));
  command->add_flag("--robot", given->robot, "Use Spikeloop's simulated robot instead of ROS");
  command->footer(kFooter);
  command->callback([given, &action] { action = [given] { return import_file(*given); }; });
}

}  // namespace spikeloop::app::import_command
