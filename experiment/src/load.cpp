#include <fmt/format.h>

#include <filesystem>

#include "faults.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {
namespace {

void add(const Error& error, Loaded& loaded) {
  loaded.diagnostics.push_back(diagnostic_of(error));
}

/// What a plug-in that is refused would have brought is not said to be unknown.
template <typename Work>
void attempt(Loaded& loaded, const Location& where, Work&& work) {
  try {
    located_at(where, [&] { return work(), 0; });
  } catch (const Error& error) {
    add(error, loaded);
    loaded.types.set_incomplete();
  }
}

void load_plugins(const ExperimentFile& file, const std::filesystem::path& directory,
                  Loaded& loaded) {
  attempt(loaded, {}, [&] { loaded.types.load_plugin_path(plugin_path()); });
  for (const WrittenValue& plugin : file.plugins) {
    attempt(loaded, plugin.where, [&] {
      require_code_may_run(fmt::format("plug-in '{}'", plugin.text));
      FilesRead::note((directory / plugin.text).string());
      loaded.types.load_plugin((directory / plugin.text).string());
    });
  }
}

}  // namespace

std::unique_ptr<Loaded> load(const std::string& path, const Overrides& overrides,
                             const LookAtRobot& look_at_robot) {
  auto loaded = std::make_unique<Loaded>();
  try {
    const ExperimentFile file = read_experiment_file(
        path, [&](const ConfigurationError& error) { add(error, *loaded); }, overrides.settings);
    const std::filesystem::path directory = directory_of(origin_of(file, overrides));
    const FilesRead files;
    load_plugins(file, directory, *loaded);
    loaded->experiment =
        resolve(file, loaded->types, overrides, loaded->diagnostics, look_at_robot);
    loaded->experiment->files = files.paths();
  } catch (const Error& error) {
    add(error, *loaded);
  }
  return loaded;
}

}  // namespace spikeloop::experiment
