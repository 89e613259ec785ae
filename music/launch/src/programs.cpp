#include "spikeloop/launch/programs.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/config/script_file.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop::launch {
namespace {

constexpr auto kContinuous = PortKind::signal;
constexpr auto kEvents = PortKind::spikes;

constexpr ExternalAddress kTopic{"ros_topic"};

/// The port `data_stamp` of the ROS adapters is continuous, like their others.
constexpr std::array kPrograms{
    Program{.name = "ros_sensor_adapter",
            .output = kContinuous,
            .source = true,
            .ros = true,
            .tells_age = true,
            .external = kTopic},
    // No `data_stamp`: a camera that sees nothing new sends nothing, so silence is no age.
    Program{.name = "ros_event_sensor_adapter",
            .output = kEvents,
            .source = true,
            .ros = true,
            .external = kTopic},
    Program{.name = "ros_command_adapter",
            .input = kContinuous,
            .ros = true,
            .measures_age = true,
            .external = kTopic},
    Program{.name = "ros_cont_adapter",
            .output = kContinuous,
            .source = true,
            .ros = true,
            .tells_age = true,
            .external = kTopic},
    Program{.name = "cont_ros_adapter",
            .input = kContinuous,
            .ros = true,
            .measures_age = true,
            .external = {"ros_topic", "/cmd_vel"}},
    Program{.name = "zmq_cont_adapter",
            .output = kContinuous,
            .source = true,
            .external = {"zmq_addr", "tcp://localhost:5555"}},
    Program{.name = "cont_zmq_adapter",
            .input = kContinuous,
            .external = {"zmq_addr", "tcp://127.0.0.1:5556"}},
    Program{.name = "spikeloop-network", .input = kEvents, .output = kEvents},
    Program{.name = "spike_playback", .output = kEvents, .source = true},
    Program{.name = "signal_playback", .output = kContinuous, .source = true},
};

/// Of a plug-in's class, whose section says the kinds of its ports.
constexpr std::array kPluginNodes{
    Program{.name = "spikeloop-node",
            .node = "continuous->continuous",
            .input = kContinuous,
            .output = kContinuous},
    Program{.name = "spikeloop-node",
            .node = "continuous->spikes",
            .input = kContinuous,
            .output = kEvents},
    Program{.name = "spikeloop-node",
            .node = "spikes->continuous",
            .input = kEvents,
            .output = kContinuous},
    Program{
        .name = "spikeloop-node", .node = "spikes->spikes", .input = kEvents, .output = kEvents},
};

/// Of a plug-in's class whose section does not.
constexpr Program kAnyNode{.name = "spikeloop-node", .any_class = true};

constexpr Program kScript{.name = "script", .any_class = true, .script = true};
constexpr Program kNestScript{
    .name = "script", .any_class = true, .script = true, .rounds_times = true};
/// Runs the script of its key `script`.
constexpr std::string_view kScriptProgram = "spikeloop-script";

/// The nodes of an experiment that share a process; `ros` says whose topics are.
constexpr std::string_view kFusedProgram = "spikeloop-fused";
constexpr Program kFused{.name = kFusedProgram, .source = true, .any_class = true};
constexpr Program kFusedOverRos{
    .name = kFusedProgram, .source = true, .ros = true, .commands_robot = true, .any_class = true};

/// The kind of a script that uses our package; null: it does not, or cannot be read, which is said
/// when it is started.
const Program* program_of_script(const std::string& path) {
  try {
    switch (host_in_script(path)) {
      case ScriptHost::nest:
        return &kNestScript;
      case ScriptHost::other:
        return &kScript;
      case ScriptHost::none:
        break;
    }
  } catch (const FileError&) {
  }
  return nullptr;
}

const Program* program_of_binary(const MusicFile& file, const MusicSection& section) {
  const MusicKey* binary = file.find_key(section, "binary");
  if (binary == nullptr) {
    return nullptr;
  }
  const std::string directory = working_directory(file, section, directory_of(file.path));
  const std::string path =
      find_executable(binary->value, directory, program_environment().at("PATH"));
  std::ifstream script(path);
  std::string line;
  return std::getline(script, line) && line.starts_with("#!") ? program_of_script(path) : nullptr;
}

/// A program of ours, whatever it runs.
const Program* program_of_key(const MusicFile& file, const MusicSection& section) {
  const MusicKey* script = file.find_key(section, "script");
  const std::string directory = working_directory(file, section, directory_of(file.path));
  const Program* found =
      script == nullptr
          ? nullptr
          : program_of_script((std::filesystem::path(directory) / script->value).string());
  return found == nullptr ? &kScript : found;
}

/// That of the class's port, when it has one of this name.
std::optional<PortKind> kind_of(const NodeDescription& node_class, const char* port) {
  const auto found = std::ranges::find(node_class.ports, port, &PortDescription::name);
  return found == node_class.ports.end() ? std::nullopt : std::optional(found->kind);
}

/// The built-in node classes: under the names of the older programs, and under spikeloop-node's.
std::vector<Program> make_node_programs() {
  static Registry registry;  // programs refer to it
  register_nodes(registry);
  std::vector<Program> programs;
  const auto add = [&](std::string_view name, std::string_view node) {
    const NodeDescription& description = registry.find(node).description;
    programs.push_back({.name = name,
                        .node = description.name,
                        .input = kind_of(description, "in"),
                        .output = kind_of(description, "out")});
  };
  for (const NodeProgram& program : node_programs()) {
    add(program.name, program.node_class);
  }
  for (const std::string& name : registry.names()) {
    add("spikeloop-node", name);
  }
  return programs;
}

const std::vector<Program>& known_node_programs() {
  static const std::vector<Program> programs = make_node_programs();
  return programs;
}

template <typename Table>
const Program* find_node(const Table& table, std::string_view node) {
  const auto found = std::ranges::find(table, node, &Program::node);
  return found == std::end(table) ? nullptr : &*found;
}

/// What spikeloop-node is in this section.
const Program* program_of_node(const MusicFile& file, const MusicSection& section,
                               std::string_view node) {
  if (node.empty()) {
    return &kAnyNode;
  }
  if (const Program* program = find_node(known_node_programs(), node)) {
    return program;
  }
  const MusicKey* ports = file.find_key(section, "ports");
  const Program* program = ports == nullptr ? nullptr : find_node(kPluginNodes, ports->value);
  return program == nullptr ? &kAnyNode : program;
}

}  // namespace

std::vector<std::string_view> program_names() {
  std::vector<std::string_view> names;
  std::ranges::transform(kPrograms, std::back_inserter(names), &Program::name);
  std::ranges::transform(node_programs(), std::back_inserter(names), &NodeProgram::name);
  return names;
}

std::string what_runs(const MusicFile& file, const MusicSection& section) {
  const std::string program = program_of(section);
  const MusicKey* script = program == kScriptProgram ? file.find_key(section, "script") : nullptr;
  return script == nullptr ? program : std::filesystem::path(script->value).filename().string();
}

std::string working_directory(const MusicFile& file, const MusicSection& section,
                              const std::string& directory) {
  const MusicKey* wd = file.find_key(section, "wd");
  return wd == nullptr ? directory : (std::filesystem::path(directory) / wd->value).string();
}

const Program* find_program(const MusicFile& file, const MusicSection& section) {
  const std::string name = program_of(section);
  if (name == kScriptProgram) {
    return program_of_key(file, section);
  }
  if (name == kFusedProgram) {
    const MusicKey* ros = file.find_key(section, "ros");
    return ros != nullptr && ros->value != "none" ? &kFusedOverRos : &kFused;
  }
  if (name == kAnyNode.name) {
    const MusicKey* node = file.find_key(section, "node");
    return program_of_node(file, section, node == nullptr ? "" : node->value);
  }
  if (const auto* const found = std::ranges::find(kPrograms, name, &Program::name);
      found != kPrograms.end()) {
    return found;
  }
  if (const NodeProgram* program = find_node_program(name)) {
    return &*std::ranges::find(known_node_programs(), program->name, &Program::name);
  }
  return program_of_binary(file, section);
}

const Program* find_program(const MusicFile& file, std::string_view label) {
  const MusicSection* section = file.find_section(label);
  return section == nullptr ? nullptr : find_program(file, *section);
}

bool is_continuous(const MusicFile& file, const MusicConnection& connection) {
  const Program* sender = find_program(file, connection.from_app);
  if (sender != nullptr && sender->output) {
    return sender->output == PortKind::signal;
  }
  const Program* receiver = find_program(file, connection.to_app);
  return receiver != nullptr && receiver->input == PortKind::signal;
}

bool all_ours(const MusicFile& file) {
  return std::all_of(file.sections.begin(), file.sections.end(), [&file](const auto& section) {
    return find_program(file, section) != nullptr;
  });
}

bool any_script(const MusicFile& file) {
  return std::any_of(file.sections.begin(), file.sections.end(), [&file](const auto& section) {
    const Program* program = find_program(file, section);
    return program != nullptr && program->script;
  });
}

int ros_version(const MusicFile& file, const MusicSection& section) {
  const Program* program = find_program(file, section);
  if (program == nullptr || !program->ros) {
    return 0;
  }
  const MusicKey* key = file.find_key(section, "ros");
  return key != nullptr && key->value == "2" ? 2 : 1;
}

bool needs_ros(const MusicFile& file, int version) {
  return std::any_of(file.sections.begin(), file.sections.end(),
                     [&](const auto& section) { return ros_version(file, section) == version; });
}

}  // namespace spikeloop::launch
