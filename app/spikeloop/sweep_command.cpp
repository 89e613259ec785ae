#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "option_values.hpp"
#include "python_package.hpp"

namespace spikeloop::app::sweep_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop sweep explorer.yaml --set seed=1..100 --set sync=lockstep --out seeds
  spikeloop sweep explorer.yaml --set "encoder.rate_max=50 Hz..200 Hz by 50 Hz" --set seed=1..20 --out rates
  spikeloop sweep explorer.yaml --set "decoder.tau=[10 ms, 30 ms]" --columns wheels.sent --out taus
  spikeloop sweep explorer.yaml --set "encoder.rate_max=20 Hz..500 Hz" --samples 50 --out random
  spikeloop sweep explorer.yaml --set seed=1..100 --out seeds --slurm && sbatch seeds/job.sh

Values: [A, B] is a list; A..B are whole numbers; A..B by STEP are numbers with an optional unit; all
else is one value. Every combination is a run; with --samples, values are drawn from lists and ranges
at random, the same ones each time.

The folder of --out has results.csv, a row per run: settings, exit code, results of summary.json;
sweep.png, the results over the swept keys; and the run folders 001, 002, ... The same command
continues a sweep that was stopped. Runs that failed are named, and are rows of the table; remove a
row to repeat its run.

Exit codes: 0 all runs finished, 1 some runs failed, 2 the file, a setting or the folder is invalid,
3 Python or a program is missing, 4 a file cannot be read or written, 129, 130, 143 stopped)";

struct SweepArguments {
  std::string file;
  std::string out;
  std::string columns;
  std::vector<std::string> settings;
  int jobs = 0;
  int samples = 0;
  bool slurm = false;
  bool quiet = false;
};

std::vector<std::string> arguments_of(const SweepArguments& given) {
  std::vector<std::string> words{"--out=" + given.out};
  for (const std::string& setting : given.settings) {
    words.push_back("--set=" + setting);
  }
  if (given.jobs > 0) {
    words.push_back("--jobs=" + std::to_string(given.jobs));
  }
  if (given.samples > 0) {
    words.push_back("--samples=" + std::to_string(given.samples));
  }
  if (!given.columns.empty()) {
    words.push_back("--columns=" + given.columns);
  }
  if (given.slurm) {
    words.emplace_back("--slurm");
  }
  if (given.quiet) {
    words.emplace_back("--quiet");
  }
  words.insert(words.end(), {"--", given.file});
  return words;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto given = std::make_shared<SweepArguments>();
  CLI::App* command =
      app.add_subcommand("sweep", "Run an experiment with many settings, and tabulate the results");
  command->add_option("FILE", given->file, "Experiment file")->required()->check(named("file"));
  command->add_option("--set", given->settings, "Values of a key; repeatable")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false)
      ->required();
  command->add_option("--out", given->out, "Folder for table and runs")
      ->check(named("folder"))
      ->required();
  command
      ->add_option("-j,--jobs", given->jobs,
                   "Runs at a time [lockstep and unpaced: one per core; else 1]")
      ->check(CLI::PositiveNumber);
  command->add_option("--samples", given->samples, "Number of runs with random values")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--columns", given->columns, "Counters for the table, comma-separated")
      ->type_name("NAME,NAME");
  command->add_flag("--slurm", given->slurm,
                    "Write job.sh, a Slurm job array with a task per run, and run nothing");
  command->add_flag("-q,--quiet", given->quiet, "Print only the table's path, warnings and errors");
  command->footer(kFooter);
  command->callback([given, &action] {
    action = [given]() -> int {
      become_python("spikeloop.sweep", arguments_of(*given), "which starts the runs",
                    "python3-h5py");
    };
  });
}

}  // namespace spikeloop::app::sweep_command
