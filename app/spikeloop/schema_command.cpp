#include "commands.hpp"

#include <CLI/CLI.hpp>
#include "output.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/experiment/schema.hpp"

namespace spikeloop::app::schema_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop schema > spikeloop.schema.json

and, as the first line of an experiment file in the same folder,

  # yaml-language-server: $schema=spikeloop.schema.json

Editors with the YAML language server then complete and check keys, units and values as you type.
Plug-ins in the directories of SPIKELOOP_PLUGIN_PATH are included. `spikeloop check` also checks
files, widths, cycles and topics.)";

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
