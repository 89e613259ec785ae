#include "commands.hpp"

#include <CLI/CLI.hpp>
#include "output.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/experiment/schema.hpp"

namespace spikeloop::app::schema_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop schema > spikeloop.schema.json

and, as the first line of an experiment beside it,

  # yaml-language-server: $schema=spikeloop.schema.json

Then editors with YAML's language server complete and check keys, units and values while they are
written. Plug-ins in the directories of SPIKELOOP_PLUGIN_PATH are included. `spikeloop check` sees
more: files, widths, cycles, topics.)";

int print_schema() {
  experiment::NodeTypes types;
  types.load_plugin_path(plugin_path());
  put_result(experiment::json_schema(types));
  return 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("schema", "Print the JSON Schema of experiment files, for editors");
  command->footer(kFooter);
  command->callback([&action] { action = print_schema; });
}

}  // namespace spikeloop::app::schema_command
