#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "option_values.hpp"
#include "python_package.hpp"

namespace spikeloop::app::summary_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop summary runs/explorer-1                     results of a run
  spikeloop summary runs/explorer-1 runs/explorer-2     a column per run, and settings that differ

Exit codes: 0 success, 3 Python is missing, 4 a folder has no summary.json that can be read)";

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto folders = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("summary", "Print or compare the results of runs");
  command->add_option("RUN", *folders, "Run folders")->required()->check(named("run folder"));
  command->footer(kFooter);
  command->callback([folders, &action] {
    action = [folders]() -> int {
      std::vector<std::string> words{"--"};
      words.insert(words.end(), folders->begin(), folders->end());
      become_python("spikeloop.summary", words, "which prints the table", "python3-h5py");
    };
  });
}

}  // namespace spikeloop::app::summary_command
