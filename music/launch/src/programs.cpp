#include "spikeloop/launch/programs.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/config/script_file.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::launch {
namespace {

constexpr auto kContinuous = Kind::continuous;
constexpr auto kEvents = Kind::events;

constexpr Outside kTopic{"ros_topic"};

/// The port `pace` of the ROS adapters is continuous, like their others.
constexpr std::array kPrograms{
    Program{.name = "ros_sensor_adapter",
            .output = kContinuous,
            .source = true,
            .ros = true,
            .tells_age = true,
            .outside = kTopic},
    // No `pace`: a camera that sees nothing new sends nothing, so silence is no age.
    Program{.name = "ros_event_sensor_adapter",
            .output = kEvents,
            .source = true,
            .ros = true,
            .outside = kTopic},
    Program{.name = "ros_command_adapter",
            .input = kContinuous,
            .ros = true,
            .measures_age = true,
            .outside = kTopic},
    Program{.name = "ros_cont_adapter",
            .output = kContinuous,
            .source = true,
            .ros = true,
            .tells_age = true,
            .outside = kTopic},
    Program{.name = "cont_ros_adapter",
            .input = kContinuous,
            .ros = true,
            .measures_age = true,
            .outside = {"ros_topic", "/cmd_vel"}},
    Program{.name = "zmq_cont_adapter",
            .output = kContinuous,
            .source = true,
            .outside = {"zmq_addr", "tcp://localhost:5555"}},
    Program{.name = "cont_zmq_adapter",
            .input = kContinuous,
            .outside = {"zmq_addr", "tcp://127.0.0.1:5556"}},
    Program{
        .name = "connect_adapter", .node = "connect", .input = kContinuous, .output = kContinuous},
    Program{.name = "cont_cont_adapter",
            .node = "connect",
            .input = kContinuous,
            .output = kContinuous},
    Program{.name = "threshold_adapter",
            .node = "threshold",
            .input = kContinuous,
            .output = kContinuous},
    Program{
        .name = "sigmoid_adapter", .node = "sigmoid", .input = kContinuous, .output = kContinuous},
    Program{
        .name = "argmax_adapter", .node = "argmax", .input = kContinuous, .output = kContinuous},
    Program{.name = "discretize_adapter",
            .node = "discretize",
            .input = kContinuous,
            .output = kContinuous},
    Program{
        .name = "rate_encoder", .node = "rate_encoder", .input = kContinuous, .output = kEvents},
    Program{.name = "poisson_encoder",
            .node = "poisson_encoder",
            .input = kContinuous,
            .output = kEvents},
    Program{.name = "nef_encoder", .node = "nef_encoder", .input = kContinuous, .output = kEvents},
    Program{.name = "linear_readout_decoder",
            .node = "linear_readout",
            .input = kEvents,
            .output = kContinuous},
    Program{.name = "linear_decoder",
            .node = "linear_readout",
            .input = kEvents,
            .output = kContinuous},
    Program{.name = "spikeloop-network", .input = kEvents, .output = kEvents},
    // An experiment in one process, which MUSIC does not start.
    Program{.name = "spikeloop-fused", .input = kContinuous, .source = true, .ros = true},
    Program{.name = "spike_playback", .output = kEvents, .source = true},
    Program{.name = "signal_playback", .output = kContinuous, .source = true},
};

/// Of classes that no program of its own runs, spikeloop-node alone.
constexpr std::array kOtherNodes{
    Program{.name = "spikeloop-node", .node = "clip", .input = kContinuous, .output = kContinuous},
    Program{
        .name = "spikeloop-node", .node = "normalise", .input = kContinuous, .output = kContinuous},
    Program{
        .name = "spikeloop-node", .node = "low_pass", .input = kContinuous, .output = kContinuous},
    Program{.name = "spikeloop-node", .node = "delay", .input = kContinuous, .output = kContinuous},
    Program{
        .name = "spikeloop-node", .node = "function", .input = kContinuous, .output = kContinuous},
    Program{.name = "spikeloop-node",
            .node = "population_encoder",
            .input = kContinuous,
            .output = kEvents},
    Program{.name = "spikeloop-node",
            .node = "step_forward_encoder",
            .input = kContinuous,
            .output = kEvents},
    Program{.name = "spikeloop-node",
            .node = "temporal_contrast_encoder",
            .input = kContinuous,
            .output = kEvents},
    Program{.name = "spikeloop-node",
            .node = "time_to_first_spike_encoder",
            .input = kContinuous,
            .output = kEvents},
    Program{.name = "spikeloop-node",
            .node = "population_vector",
            .input = kEvents,
            .output = kContinuous},
    Program{.name = "spikeloop-node",
            .node = "winner_take_all",
            .input = kEvents,
            .output = kContinuous},
    Program{
        .name = "spikeloop-node", .node = "rate_window", .input = kEvents, .output = kContinuous},
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

/// The nodes of an experiment that has simulators beside it; `ros` says whose topics are.
constexpr std::string_view kFusedProgram = "spikeloop-fused-music";
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

template <typename Table>
const Program* find_node(const Table& table, std::string_view node) {
  const auto* const found = std::ranges::find(table, node, &Program::node);
  return found == std::end(table) ? nullptr : found;
}

/// What spikeloop-node is in this section.
const Program* program_of_node(const MusicFile& file, const MusicSection& section,
                               std::string_view node) {
  if (node.empty()) {
    return &kAnyNode;
  }
  if (const Program* program = find_node(kPrograms, node)) {
    return program;
  }
  if (const Program* program = find_node(kOtherNodes, node)) {
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
  return names;
}

std::vector<std::string_view> programs_of_node(std::string_view node) {
  std::vector<std::string_view> names;
  for (const Program& program : kPrograms) {
    if (program.node == node) {
      names.push_back(program.name);
    }
  }
  return names;
}

std::string_view node_of_program(std::string_view name) {
  const auto* const found = std::ranges::find(kPrograms, name, &Program::name);
  return found == kPrograms.end() ? "" : found->node;
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
  return program_of_binary(file, section);
}

const Program* find_program(const MusicFile& file, std::string_view label) {
  const MusicSection* section = file.find_section(label);
  return section == nullptr ? nullptr : find_program(file, *section);
}

bool is_continuous(const MusicFile& file, const MusicConnection& connection) {
  const Program* sender = find_program(file, connection.from_app);
  if (sender != nullptr && sender->output) {
    return sender->output == Kind::continuous;
  }
  const Program* receiver = find_program(file, connection.to_app);
  return receiver != nullptr && receiver->input == Kind::continuous;
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
