#include "commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "check_command.hpp"
#include "experiment_command.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/launch/effective_file.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/hostfile.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::app::export_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop export loop.music                        prints effective file and mpirun command
  spikeloop export explorer.yaml --out job           writes a MUSIC job with one process per node
  spikeloop export loop.music --out job              writes job/effective.music; prints the command
  spikeloop export loop.music --out job --srun       also writes job/programs.conf, for srun
  spikeloop export loop.music --out job --hostfile hosts

For clusters on which a batch system starts programs. Such a job is not supervised: if a program
hangs, the whole job hangs. On every host, the Spikeloop programs must be in PATH, and for scripts
that import spikeloop also share/spikeloop/python in PYTHONPATH.)";

struct Arguments {
  std::string file;
  std::string folder;
  std::string hostfile;
  bool srun = false;
};

/// Nobody but the user sets variables for such a job; what a foreign program reads, nobody knows.
launch::Hosts hosts_of(const Arguments& arguments, const MusicFile& file) {
  launch::Hosts hosts{.hostfile = arguments.hostfile, .variables = {"PATH"}};
  const std::vector<std::string> of_ros = launch::ros_variables();
  hosts.variables.insert(hosts.variables.end(), of_ros.begin(), of_ros.end());
  if (launch::any_script(file) && std::getenv("PYTHONPATH") != nullptr) {
    hosts.variables.emplace_back("PYTHONPATH");
  }
  if (!arguments.hostfile.empty()) {
    launch::check_hostfile(arguments.hostfile);
    hosts.hostfile = std::filesystem::absolute(arguments.hostfile).string();
  }
  return hosts;
}

using Translate = std::function<std::string(const std::string&)>;

/// `translate`: what is said of the file, for whoever did not write it.
int export_job(const Arguments& arguments, const Translate& translate) {
  if (arguments.srun && arguments.folder.empty()) {
    throw ConfigurationError(
        "--srun needs a folder for the list of programs; give one with --out, as in --out job");
  }
  MusicFile file = read_music_file(arguments.file);
  const launch::Hosts hosts = hosts_of(arguments, file);
  Diagnostics diagnostics = launch::check_job(file, {}, false);
  for (Diagnostic& found : diagnostics) {
    found = {{}, translate(found.text()), found.exit_code};
    if (!found.is_error()) {
      put(stderr, fmt::format("spikeloop: warning: {}\n", found.message));
    }
  }
  if (has_errors(diagnostics)) {
    return refuse(diagnostics, arguments.file);
  }
  const std::string directory = launch::directory_of(arguments.file);
  const launch::EffectiveFile effective = launch::make_effective(std::move(file), {});
  const std::string text = to_text(effective.file);
  if (arguments.folder.empty()) {
    const auto line = launch::mpirun_command(effective.file, "effective.music", hosts);
    put_result(fmt::format("# {}\n{}", launch::shell_text(line), text));
    return 0;
  }
  const std::string folder = launch::make_folder(arguments.folder);
  const std::string path = folder + "/effective.music";
  launch::refuse_to_overwrite(arguments.file, path);
  write_file(path, text);
  std::vector<std::string> line;
  if (arguments.srun) {
    const std::string programs = folder + "/programs.conf";
    write_file(programs, launch::multi_prog_text(effective.file, path));
    line = launch::srun_command(effective.file, programs, directory);
  } else {
    line = launch::mpirun_command(effective.file, path, hosts);
    line.insert(line.begin() + 1, {"--wdir", directory});
  }
  put_result(launch::shell_text(line) + "\n");
  return 0;
}

}  // namespace

namespace {

int export_file(const Arguments& arguments) {
  if (!is_experiment(arguments.file)) {
    return export_job(arguments, [](const std::string& text) { return text; });
  }
  if (arguments.folder.empty()) {
    throw ConfigurationError(
        "an experiment is exported to a folder; give one with --out, as in --out job");
  }
  return use_experiment(arguments.file, [&](const experiment::Experiment& experiment) {
    if (experiment.layout.kind == experiment::Layout::Kind::written) {
      put(stderr, "spikeloop: warning: key 'layout': an exported job has one program per node\n");
    }
    Arguments job = arguments;
    const WrittenJob written = write_music_job(experiment, arguments.folder);
    job.file = written.path;
    return export_job(job, written.places);
  });
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("export", "Write the effective .music file; print the command to run it");
  command->add_option("FILE", arguments->file, "Experiment file or MUSIC configuration file")
      ->required();
  command->add_option("--out", arguments->folder, "Output folder")->check(named("folder"));
  auto* srun = command->add_flag("--srun", arguments->srun, "Use Slurm's srun instead of mpirun");
  command->add_option("--hostfile", arguments->hostfile, "Open MPI hostfile")
      ->check(named("hostfile"))
      ->excludes(srun);
  add_no_code(*command);
  command->footer(kFooter);
  command->callback(
      [arguments, &action] { action = [arguments] { return export_file(*arguments); }; });
}

}  // namespace spikeloop::app::export_command
