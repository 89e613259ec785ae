#include "commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "experiment_text.hpp"
#include "message_text.hpp"
#include "node_text.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "own_programs.hpp"
#include "robot_text.hpp"
#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop::app::describe_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop describe                      lists the node classes
  spikeloop describe rate_encoder         its ports and parameters
  spikeloop describe --markdown           the page of all built-in classes, docs/nodes.md

  spikeloop describe sensor_msgs/JointState   definition, checksums, field paths of a message
  spikeloop describe my_robot/msg/Arm.msg     the same for a message file
  spikeloop describe --messages               lists the built-in message types

  spikeloop describe arm.xml              topics, joints, actuators of a robot in MJCF

  spikeloop describe --experiment         the keys of experiment files
  spikeloop describe --experiment --markdown   the same for docs/experiment-file.md

Plug-ins in the directories of SPIKELOOP_PLUGIN_PATH are included, but not in the page. MUSIC
programs that are not node classes, such as ros_sensor_adapter, have --help.)";

[[noreturn]] void refuse(const std::string& name, const Registry& registry) {
  std::vector<std::string> known = all_programs();
  if (std::ranges::find(known, name) != known.end()) {
    const NodeProgram* program = find_node_program(name);
    throw ConfigurationError(fmt::format(
        "'{0}' is a program, not a node class; see {0} --help{1}", name,
        program == nullptr
            ? ""
            : fmt::format(", or spikeloop describe {} for what it runs", program->node_class)));
  }
  auto classes = registry.names();
  const auto more = experiment_classes(experiment::NodeTypes());
  classes.insert(classes.end(), more.begin(), more.end());
  std::ranges::sort(classes);
  known.insert(known.end(), classes.begin(), classes.end());
  // A program may be meant, but the list of what there is has classes alone.
  throw ConfigurationError(
      fmt::format("unknown node class '{}'{}", name,
                  did_you_mean(name, nearest(name, known).empty() ? classes : known)));
}

void load_plugins(Registry& registry) {
  registry.load_plugin_path(plugin_path());
}

/// The nodes of experiment files that no MUSIC program runs; null for any other name.
const NodeDescription* find_in_experiments(const experiment::NodeTypes& types,
                                           const std::string& name) {
  if (name == experiment::simulator_description().name) {
    return &experiment::simulator_description();
  }
  const auto names = experiment_classes(types);
  return std::ranges::find(names, name) == names.end() ? nullptr : &types.find(name).description;
}

std::string name_lines(const Registry& registry) {
  auto names = registry.names();
  const auto more = experiment_classes(experiment::NodeTypes());
  names.insert(names.end(), more.begin(), more.end());
  names.push_back(experiment::simulator_description().name);
  return fmt::format("{}\n", fmt::join(names, "\n"));
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
  bool experiment = false;
  bool markdown = false;
  bool names = false;
  bool messages = false;
};

int describe(const DescribeArguments& arguments) {
  const experiment::NodeTypes types;
  if (arguments.experiment) {
    put_result(experiment_reference(types, arguments.markdown));
    return 0;
  }
  if (arguments.messages) {
    put_result(message_list());
    return 0;
  }
  if (arguments.name.ends_with(".xml")) {
    put_result(robot_text(arguments.name));
    return 0;
  }
  if (is_message_type(arguments.name)) {
    put_result(message_text(arguments.name));
    return 0;
  }
  Registry registry;
  register_nodes(registry);
  if (arguments.markdown) {
    put_result(reference_page(registry));
    return 0;
  }
  if (arguments.names) {
    return list_names(registry);
  }
  if (const NodeDescription* description = find_in_experiments(types, arguments.name)) {
    put_result(experiment_class_text(*description));
    return 0;
  }
  load_plugins(registry);
  if (arguments.name.empty()) {
    put_result(class_list(registry) + experiment_class_list(types) +
               "spikeloop describe NODE prints details.\n");
    return 0;
  }
  if (!registry.contains(arguments.name)) {
    refuse(arguments.name, registry);
  }
  put_result(class_text(registry.find(arguments.name).description));
  return 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<DescribeArguments>();
  CLI::App* command =
      app.add_subcommand("describe", "Describe a node class, a message type or a robot");
  auto* name = command
                   ->add_option("NODE", arguments->name,
                                "Node class, message type, or MJCF file; not given: all classes")
                   ->check(named("node class"));
  auto* markdown =
      command->add_flag("--markdown", arguments->markdown, "Print the page of all built-in classes")
          ->excludes(name);
  auto* experiment = command
                         ->add_flag("--experiment", arguments->experiment,
                                    "Print the keys of experiment files and their additional nodes")
                         ->excludes(name);
  command->add_flag("--names", arguments->names, "Print only the names, one per line")
      ->excludes(name)
      ->excludes(markdown)
      ->excludes(experiment);
  command->add_flag("--messages", arguments->messages, "Print the names of all message types")
      ->excludes(name)
      ->excludes(markdown)
      ->excludes(experiment);
  command->footer(kFooter);
  command->callback(
      [arguments, &action] { action = [arguments] { return describe(*arguments); }; });
}

}  // namespace spikeloop::app::describe_command
