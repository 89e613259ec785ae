#include "spikeloop/launch/programs.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "spikeloop/config/dialect.hpp"

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
};

constexpr Program kAnyNode{.name = "spikeloop-node", .any_class = true};

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

std::string working_directory(const MusicFile& file, const MusicSection& section,
                              const std::string& directory) {
  const MusicKey* wd = file.find_key(section, "wd");
  return wd == nullptr ? directory : (std::filesystem::path(directory) / wd->value).string();
}

const Program* find_program(const MusicFile& file, const MusicSection& section) {
  const std::string name = program_of(section);
  const bool any_node = name == kAnyNode.name;
  const MusicKey* node = any_node ? file.find_key(section, "node") : nullptr;
  const auto found = std::find_if(kPrograms.begin(), kPrograms.end(), [&](const Program& program) {
    return node == nullptr ? program.name == name : program.node == node->value;
  });
  if (found != kPrograms.end()) {
    return &*found;
  }
  return any_node ? &kAnyNode : nullptr;
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

bool needs_ros(const MusicFile& file) {
  return std::any_of(file.sections.begin(), file.sections.end(), [&file](const auto& section) {
    const Program* program = find_program(file, section);
    return program != nullptr && program->ros;
  });
}

}  // namespace spikeloop::launch
