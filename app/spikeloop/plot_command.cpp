#include "commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <vector>

#include "option_values.hpp"
#include "python_package.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::app::plot_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop plot runs/explorer-1
  spikeloop plot runs/explorer-1 --from 2 --to 2500ms --format pdf --out figures
  spikeloop plot runs/braitenberg --network network
  spikeloop plot sweep1 --format pdf

Draws figures of a run of an experiment or a .music file, and reports missing data:
  trajectory  the robot's path through its arena
  episodes    the return of every episode, and the success rate
  spikes      sensors, spikes and rates of every population, commands, above one time axis
  signals     outputs of the other nodes
  latency     from a sensor message to the first command computed from it, in wall time
and of the folder of a sweep:
  sweep       every measure over the swept keys
PYTHON selects an interpreter other than /usr/bin/python3; it needs matplotlib, h5py and numpy.

Exit codes: 0 all data were drawn, 1 some data could not be drawn, 2 an option is invalid,
3 Python or a package is missing, 4 nothing could be drawn)";

struct PlotArguments {
  std::string folder;
  std::string out;
  std::string format = "png";
  std::string from;
  std::string to;
  std::string sensor;
  std::string network;
  std::string command;
};

double moment_s(const char* option, const std::string& text) {
  try {
    const double seconds = parse_quantity(text, "s");
    if (seconds >= 0 && seconds < 1e9) {
      return seconds;
    }
  } catch (const ConfigurationError&) {
    // Told below.
  }
  throw ConfigurationError(fmt::format(
      "{}: '{}' is not a moment of a run; write for example 2.5 or \"500 ms\"", option, text));
}

std::vector<std::string> arguments_of(const PlotArguments& given) {
  std::vector<std::string> words{"--format=" + given.format};
  const auto add = [&words](const char* option, const std::string& value) {
    if (!value.empty()) {
      words.push_back(fmt::format("{}={}", option, value));
    }
  };
  add("--out", given.out);
  add("--sensor", given.sensor);
  add("--network", given.network);
  add("--command", given.command);
  add("--from", given.from.empty() ? "" : fmt::format("{}", moment_s("--from", given.from)));
  add("--to", given.to.empty() ? "" : fmt::format("{}", moment_s("--to", given.to)));
  words.insert(words.end(), {"--", given.folder});
  return words;
}

void refuse_empty_span(const PlotArguments& given) {
  if (!given.from.empty() && !given.to.empty() &&
      moment_s("--from", given.from) >= moment_s("--to", given.to)) {
    throw ConfigurationError(
        fmt::format("--from {} is not before --to {}; exchange them", given.from, given.to));
  }
}

int plot(const PlotArguments& given) {
  refuse_empty_span(given);
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(given.folder, none)) {
    if (entry.path().extension() == ".h5") {
      record::try_recording(entry.path().string());
    }
  }
  become_python("spikeloop.plots", arguments_of(given), "which draws",
                "python3-matplotlib python3-h5py");
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto given = std::make_shared<PlotArguments>();
  CLI::App* command = app.add_subcommand("plot", "Draw figures of a run or a sweep");
  command->add_option("RUN", given->folder, "Run folder, or that of a sweep")
      ->required()
      ->check(named("folder"));
  command->add_option("--out", given->out, "Folder for the figures [the run folder]")
      ->check(named("folder"));
  command->add_option("--format", given->format, "File format")
      ->check(CLI::IsMember({"png", "svg", "pdf"}))
      ->capture_default_str();
  command->add_option("--from", given->from, "Start of the time axis, in s or with a unit (2500ms)")
      ->type_name("TIME");
  command->add_option("--to", given->to, "End of the time axis, in s or with a unit")
      ->type_name("TIME");
  command->add_option("--sensor", given->sensor, "Node or process that recorded the sensor")
      ->type_name("LABEL");
  command->add_option("--network", given->network, "Draw only spikes of this node or process")
      ->type_name("LABEL");
  command->add_option("--command", given->command, "Node or process that recorded the command")
      ->type_name("LABEL");
  command->footer(kFooter);
  command->callback([given, &action] { action = [given] { return plot(*given); }; });
}

}  // namespace spikeloop::app::plot_command
