#include <filesystem>

#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {
namespace {

void add(const Error& error, Loaded& loaded) {
  loaded.faults.push_back({error.what(), error.where(), error.exit_code()});
}

/// What a plug-in that is refused would have brought is not said to be unknown.
template <typename Work>
void attempt(Loaded& loaded, const Location& where, Work&& work) {
  try {
    located_at(where, [&] { return work(), 0; });
  } catch (const Error& error) {
    add(error, loaded);
    loaded.kinds.set_incomplete();
  }
}

void load_plugins(const ExperimentFile& file, Loaded& loaded) {
  attempt(loaded, {}, [&] { loaded.kinds.load_plugin_path(plugin_path()); });
  const std::filesystem::path directory = directory_of(file.path);
  for (const WrittenValue& plugin : file.plugins) {
    attempt(loaded, plugin.where,
            [&] { loaded.kinds.load_plugin((directory / plugin.text).string()); });
  }
}

}  // namespace

std::unique_ptr<Loaded> load(const std::string& path, const Overrides& overrides,
                             const LookAtRobot& look_at_robot) {
  auto loaded = std::make_unique<Loaded>();
  try {
    const ExperimentFile file =
        read_experiment_file(path, [&](const ConfigurationError& error) { add(error, *loaded); });
    load_plugins(file, *loaded);
    loaded->experiment = resolve(file, loaded->kinds, overrides, loaded->faults, look_at_robot);
  } catch (const Error& error) {
    add(error, *loaded);
  }
  return loaded;
}

}  // namespace spikeloop::experiment
