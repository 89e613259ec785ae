#include "commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "diagram.hpp"
#include "experiment_command.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::app::graph_command {
namespace {

using experiment::Connection;
using experiment::Experiment;
using experiment::Node;

constexpr const char* kFooter = R"(Examples:
  spikeloop graph explorer.yaml --out explorer.svg
  spikeloop graph explorer.yaml --out explorer.png
  spikeloop graph loop.music > loop.svg
  spikeloop graph explorer.yaml --out explorer.dot    for other programs of Graphviz

Shows nodes with their classes, connections with kind, width and delay, and the robot. A .music
file has one box per section. The file extension selects the format. Needs Graphviz (Debian:
graphviz).

Loads the plug-ins that FILE names and runs its networks in Python, with your permissions, as
`spikeloop check` does. Use --no-code for an untrusted file.)";

constexpr const char* kDrawer = "dot";
const std::vector<std::string> kFormats = {"svg", "png", "pdf", "dot"};

/// Boxes by their names.
class Builder {
 public:
  explicit Builder(Diagram& diagram) : diagram_(diagram) {}

  void add(Box box) {
    boxes_[box.name] = diagram_.boxes.size();
    diagram_.boxes.push_back(std::move(box));
  }
  void connect(const std::string& from, const std::string& to, ArrowStyle style,
               const std::string& label, bool delayed) {
    diagram_.arrows.push_back({boxes_.at(experiment::node_of(from)),
                               boxes_.at(experiment::node_of(to)), experiment::port_of(from),
                               experiment::port_of(to), style, label, delayed});
  }

 private:
  Diagram& diagram_;
  std::map<std::string, std::size_t> boxes_;
};

std::string any_robot(const std::string& ros) {
  return fmt::format("ROS {}: any robot", ros);
}

Box box_of(const Node& node) {
  Box box;
  box.name = node.name;
  box.kind = node.kind;
  box.network = node.kind == experiment::kNetwork || experiment::is_simulator(node);
  if (experiment::has_topic(node.kind)) {
    box.topic = node.parameters.text("topic");
    box.sends = node.kind == experiment::kRosCommand;
  }
  return box;
}

std::string label_of(const Connection& connection, TimeNs tick) {
  const bool delayed = connection.delay_ticks.value_or(0) > 0;
  const std::string channels = connection.channels.text();  // with brackets
  return fmt::format(
      "[{}{}]",
      channels.empty() ? std::to_string(connection.width) : channels.substr(1, channels.size() - 2),
      delayed ? ", delay " + format_time(*connection.delay_ticks * tick) : "");
}

Diagram diagram_of(const Experiment& experiment) {
  Diagram diagram;
  diagram.title = experiment.name;
  diagram.frame = fmt::format("one process{}, tick {}, {}",
                              experiment::has_simulator(experiment) ? " and its simulators" : "",
                              format_time(experiment.tick), experiment::name_of(experiment.sync));
  if (experiment.robot) {
    const experiment::Robot& robot = *experiment.robot;
    diagram.robot = robot.environment   ? robot.environment->name
                    : robot.bag.empty() ? "robot in MuJoCo"
                                        : std::filesystem::path(robot.bag).filename().string();
    diagram.robot_inside = true;
  } else if (experiment.ros != experiment::Ros::none) {
    diagram.robot = any_robot(experiment::name_of(experiment.ros));
  }
  Builder builder(diagram);
  for (const Node& node : experiment.nodes) {
    builder.add(box_of(node));
  }
  for (const Connection& connection : experiment.connections) {
    const bool signal = connection.kind == PortKind::signal;
    builder.connect(connection.from, connection.to,
                    signal ? ArrowStyle::signal : ArrowStyle::spikes,
                    label_of(connection, experiment.tick), connection.delay_ticks.value_or(0) > 0);
  }
  return diagram;
}

/// A section's program, or what it runs.
Box box_of(const MusicFile& file, const MusicSection& section) {
  Box box;
  box.name = section.label;
  const MusicKey* binary = file.find_key(section, "binary");
  const std::string path = binary == nullptr ? "" : binary->value;
  box.kind = path.substr(path.rfind('/') + 1);
  box.network = box.kind == "spikeloop-network";
  const launch::Program* program = launch::find_program(file, section);
  if (program != nullptr && program->ros) {
    const MusicKey* topic = file.find_key(section, program->external.key);
    box.topic = topic == nullptr ? std::string(program->external.otherwise) : topic->value;
    box.sends = program->input.has_value();
  }
  return box;
}

Diagram diagram_of(const MusicFile& file) {
  Diagram diagram;
  diagram.title = file.path.substr(file.path.rfind('/') + 1);
  diagram.frame = "one MUSIC job: a process a box";
  Builder builder(diagram);
  for (const MusicSection& section : file.sections) {
    const Box box = box_of(file, section);
    diagram.robot = box.topic.empty()
                        ? diagram.robot
                        : any_robot(std::to_string(launch::ros_version(file, section)));
    builder.add(box);
  }
  for (const MusicConnection& connection : file.connections) {
    const bool signal = launch::is_continuous(file, connection);
    builder.connect(connection.from_app + "." + connection.from_port,
                    connection.to_app + "." + connection.to_port,
                    signal ? ArrowStyle::signal : ArrowStyle::spikes,
                    connection.width ? fmt::format("[{}]", *connection.width) : "", false);
  }
  return diagram;
}

std::string with_ending(const std::string& path, const std::string& ending) {
  const auto name = path.rfind('/') + 1;
  const auto dot = path.rfind('.');
  return (dot == std::string::npos || dot <= name ? path : path.substr(0, dot)) + "." + ending;
}

/// "svg" of "explorer.svg", and of no file.
std::string format_of(const std::string& path) {
  if (path.empty()) {
    return kFormats.front();
  }
  const auto format = std::ranges::find_if(
      kFormats, [&](const std::string& ending) { return path.ends_with("." + ending); });
  if (format == kFormats.end()) {
    throw ConfigurationError(fmt::format("--out: '{}' does not end in .{}; write  --out {}", path,
                                         fmt::join(kFormats, ", ."),
                                         with_ending(path, kFormats.front())));
  }
  return *format;
}

void need_drawer() {
  if (launch::find_executable(kDrawer, "", launch::program_environment().at("PATH")).empty()) {
    throw TransportError(
        "Graphviz draws the picture, and its program 'dot' is not in PATH; install it (Debian: apt "
        "install graphviz), or write  --out FILE.dot");
  }
}

/// Twice as large as the SVG where it is made of pixels, for screens and slides.
void write_picture(const std::string& dot, const std::string& path, const std::string& format) {
  std::vector<std::string> words{kDrawer, "-T" + format, "-Gdpi=144"};
  if (format != "png") {
    words.pop_back();
  }
  if (!path.empty()) {
    make_empty_file(path);  // Graphviz would write to the target of a link
    words.insert(words.end(), {"-o", path});
  }
  if (!feed(words, dot)) {
    throw FileError(fmt::format("Graphviz's program 'dot' has failed for '{}'; write  --out {}",
                                path, with_ending(path.empty() ? "FILE" : path, "dot")));
  }
}

int draw(const std::string& path, const std::string& out) {
  const std::string format = format_of(out);
  if (format != "dot") {
    need_drawer();
  }
  const auto show = [&](const Diagram& diagram) {
    const std::string dot = to_dot(diagram);
    format == "dot" ? write_file(out, dot) : write_picture(dot, out, format);
    return 0;
  };
  if (is_experiment(path)) {
    return use_experiment(
        path, [&](const Experiment& experiment) { return show(diagram_of(experiment)); });
  }
  const MusicFile file = read_music_file(path);
  check_structure(file);
  return show(diagram_of(file));
}

}  // namespace

void add(CLI::App& app, Action& action) {
  struct Arguments {
    std::string file;
    std::string out;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("graph", "Draw an experiment or a .music file");
  command->add_option("FILE", arguments->file, "Experiment file or MUSIC configuration file")
      ->required();
  command->add_option("--out", arguments->out,
                      "Output file: FILE.svg, .png, .pdf or .dot [SVG to standard output]");
  add_no_code(*command);
  command->footer(kFooter);
  command->callback([arguments, &action] {
    action = [arguments] { return draw(arguments->file, arguments->out); };
  });
}

}  // namespace spikeloop::app::graph_command
