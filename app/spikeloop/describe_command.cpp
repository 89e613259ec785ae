#include "describe_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "experiment_text.hpp"
#include "node_text.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop describe                      the node classes, a line each
  spikeloop describe rate_encoder         its ports and parameters
  spikeloop describe --markdown           the page of all built-in classes: docs/nodes.md

  spikeloop describe --experiment         the keys of experiment files
  spikeloop describe --experiment --markdown   the same for docs/experiment-file.md

Plug-ins in the directories of SPIKELOOP_PLUGIN_PATH are included, but not in the page. MUSIC
programs that are no node classes, like ros_sensor_adapter, answer --help.)";

/// Ours that are no MUSIC programs under a name the launcher knows.
constexpr const char* kMorePrograms[] = {"spikeloop",     "spikeloop-node",  "spikeloop-ros",
                                         "spikeloop-zmq", "spikeloop-robot", "spikeloop-guard"};

std::vector<std::string> all_programs() {
  std::vector<std::string> names(std::begin(kMorePrograms), std::end(kMorePrograms));
  for (const std::string_view name : launch::program_names()) {
    names.emplace_back(name);
  }
  return names;
}

[[noreturn]] void refuse(const std::string& name, const Registry& registry) {
  std::vector<std::string> known = all_programs();
  if (std::ranges::find(known, name) != known.end()) {
    const std::string_view node = launch::node_of_program(name);
    throw ConfigurationError(fmt::format(
        "'{0}' is a program, not a node class; see {0} --help{1}", name,
        node.empty() ? "" : fmt::format(", or spikeloop describe {} for what it runs", node)));
  }
  auto classes = registry.names();
  const auto more = experiment_classes(experiment::Kinds());
  classes.insert(classes.end(), more.begin(), more.end());
  std::ranges::sort(classes);
  known.insert(known.end(), classes.begin(), classes.end());
  // A program may be meant, but the list of what there is has classes alone.
  throw ConfigurationError(
      fmt::format("unknown node class '{}'{}", name,
                  did_you_mean(name, nearest(name, known).empty() ? classes : known)));
}

/// The nodes of experiment files that no MUSIC program runs; null for any other name.
const NodeDescription* find_in_experiments(const experiment::Kinds& kinds,
                                           const std::string& name) {
  const auto names = experiment_classes(kinds);
  return std::ranges::find(names, name) == names.end() ? nullptr : &kinds.find(name).description;
}

int describe(const std::string& name, bool experiment, bool markdown) {
  const experiment::Kinds kinds;
  if (experiment) {
    put_result(experiment_reference(kinds, markdown));
    return 0;
  }
  Registry registry;
  register_nodes(registry);
  if (markdown) {
    put_result(reference_page(registry));
    return 0;
  }
  if (const NodeDescription* description = find_in_experiments(kinds, name)) {
    put_result(experiment_class_text(*description));
    return 0;
  }
  if (const char* directories = std::getenv("SPIKELOOP_PLUGIN_PATH"); directories != nullptr) {
    registry.load_plugin_path(directories);
  }
  if (name.empty()) {
    put_result(class_list(registry) + experiment_class_list(kinds) +
               "spikeloop describe NODE tells more of one.\n");
    return 0;
  }
  if (!registry.contains(name)) {
    refuse(name, registry);
  }
  put_result(class_text(registry.find(name).description));
  return 0;
}

}  // namespace

void add_describe_command(CLI::App& app, std::function<int()>& action) {
  struct Arguments {
    std::string name;
    bool experiment = false;
    bool markdown = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("describe", "Show what a node class does and takes");
  auto* name = command->add_option("NODE", arguments->name, "Its name; without one, all classes")
                   ->check(named("node class"));
  command->add_flag("--markdown", arguments->markdown, "Print the page of all built-in classes")
      ->excludes(name);
  command
      ->add_flag("--experiment", arguments->experiment,
                 "The keys of experiment files, and the nodes that only they have")
      ->excludes(name);
  command->footer(kFooter);
  command->callback([arguments, &action] {
    action = [arguments] {
      return describe(arguments->name, arguments->experiment, arguments->markdown);
    };
  });
}

}  // namespace spikeloop::app
