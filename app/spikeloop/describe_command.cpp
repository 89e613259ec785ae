#include "describe_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "node_text.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "own_programs.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop describe                      the node classes, a line each
  spikeloop describe rate_encoder         its ports and parameters
  spikeloop describe --markdown           the page of all built-in classes: docs/nodes.md

Plug-ins in the directories of SPIKELOOP_PLUGIN_PATH are included, but not in the page. MUSIC
programs that are no node classes, like ros_sensor_adapter, answer --help.)";

[[noreturn]] void refuse(const std::string& name, const Registry& registry) {
  std::vector<std::string> known = all_programs();
  if (std::ranges::find(known, name) != known.end()) {
    const std::string_view node = launch::node_of_program(name);
    throw ConfigurationError(fmt::format(
        "'{0}' is a program, not a node class; see {0} --help{1}", name,
        node.empty() ? "" : fmt::format(", or spikeloop describe {} for what it runs", node)));
  }
  const auto classes = registry.names();
  known.insert(known.end(), classes.begin(), classes.end());
  // A program may be meant, but the list of what there is has classes alone.
  throw ConfigurationError(
      fmt::format("unknown node class '{}'{}", name,
                  did_you_mean(name, nearest(name, known).empty() ? classes : known)));
}

void load_plugins(Registry& registry) {
  if (const char* directories = std::getenv("SPIKELOOP_PLUGIN_PATH"); directories != nullptr) {
    registry.load_plugin_path(directories);
  }
}

std::string name_lines(const Registry& registry) {
  return fmt::format("{}\n", fmt::join(registry.names(), "\n"));
}

/// A shell that completes names has no use for an error alone: those that are known come first.
int list_names(Registry& registry) {
  try {
    load_plugins(registry);
  } catch (const Error&) {
    put_result(name_lines(registry));
    throw;
  }
  put_result(name_lines(registry));
  return 0;
}

struct DescribeArguments {
  std::string name;
  bool markdown = false;
  bool names = false;
};

int describe(const DescribeArguments& arguments) {
  Registry registry;
  register_nodes(registry);
  if (arguments.markdown) {
    put_result(reference_page(registry));
    return 0;
  }
  if (arguments.names) {
    return list_names(registry);
  }
  load_plugins(registry);
  if (arguments.name.empty()) {
    put_result(class_list(registry) + "spikeloop describe NODE tells more of one.\n");
    return 0;
  }
  if (!registry.contains(arguments.name)) {
    refuse(arguments.name, registry);
  }
  put_result(class_text(registry.find(arguments.name).description));
  return 0;
}

}  // namespace

void add_describe_command(CLI::App& app, std::function<int()>& action) {
  const auto arguments = std::make_shared<DescribeArguments>();
  CLI::App* command = app.add_subcommand("describe", "Show what a node class does and takes");
  auto* name = command->add_option("NODE", arguments->name, "Its name; without one, all classes")
                   ->check(named("node class"));
  auto* markdown =
      command->add_flag("--markdown", arguments->markdown, "Print the page of all built-in classes")
          ->excludes(name);
  command->add_flag("--names", arguments->names, "Print the names alone, a line each")
      ->excludes(name)
      ->excludes(markdown);
  command->footer(kFooter);
  command->callback(
      [arguments, &action] { action = [arguments] { return describe(*arguments); }; });
}

}  // namespace spikeloop::app
