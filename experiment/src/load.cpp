#include <filesystem>

#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {
namespace {

void add(const Error& error, Loaded& loaded) {
  loaded.faults.push_back({error.what(), error.where(), error.exit_code()});
}

void load_plugins(const ExperimentFile& file, Loaded& loaded) {
  loaded.kinds.load_plugin_path(plugin_path());
  const std::filesystem::path directory = directory_of(file.path);
  for (const WrittenValue& plugin : file.plugins) {
    try {
      located_at(plugin.where, [&] {
        loaded.kinds.load_plugin((directory / plugin.text).string());
        return 0;
      });
    } catch (const Error& error) {
      add(error, loaded);
    }
  }
}

}  // namespace

std::unique_ptr<Loaded> load(const std::string& path, const Overrides& overrides) {
  auto loaded = std::make_unique<Loaded>();
  try {
    const ExperimentFile file =
        read_experiment_file(path, [&](const ConfigurationError& error) { add(error, *loaded); });
    load_plugins(file, *loaded);
    loaded->experiment = resolve(file, loaded->kinds, overrides, loaded->faults);
  } catch (const Error& error) {
    add(error, *loaded);
  }
  return loaded;
}

}  // namespace spikeloop::experiment
