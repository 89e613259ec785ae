#include "commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>

#include "diagram.hpp"
#include "experiment_command.hpp"
#include "output.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::app::graph_command {
namespace {

using experiment::Experiment;
using experiment::Link;
using experiment::Part;

constexpr const char* kFooter = R"(Examples:
  spikeloop graph explorer.yaml --out explorer.svg
  spikeloop graph explorer.yaml --out explorer.png
  spikeloop graph loop.music > loop.svg

Nodes with their classes, connections with their kinds, widths and delays, the robot. A .music file is
drawn with a box a section. The ending says what is drawn, SVG or PNG; Debian's librsvg2-bin makes
the PNG.)";

constexpr const char* kConverter = "rsvg-convert";

/// Boxes by their names; ports appear when they are first named.
class Builder {
 public:
  explicit Builder(Diagram& diagram) : diagram_(diagram) {}

  void add(Box box) {
    boxes_[box.name] = diagram_.boxes.size();
    diagram_.boxes.push_back(std::move(box));
  }
  void connect(const std::string& from, const std::string& to, ArrowStyle style,
               const std::string& label, bool delayed) {
    Arrow arrow;
    arrow.from = boxes_.at(experiment::node_of(from));
    arrow.to = boxes_.at(experiment::node_of(to));
    arrow.from_port = port(diagram_.boxes[arrow.from].outputs, from, style);
    arrow.to_port = port(diagram_.boxes[arrow.to].inputs, to, style);
    arrow.label = label;
    arrow.delayed = delayed;
    diagram_.arrows.push_back(arrow);
  }

 private:
  static std::size_t port(std::vector<DiagramPort>& ports, const std::string& end,
                          ArrowStyle style) {
    const std::string name = end.substr(end.find('.') + 1);
    for (std::size_t i = 0; i < ports.size(); ++i) {
      if (ports[i].name == name) {
        return i;
      }
    }
    ports.push_back({name, style});
    return ports.size() - 1;
  }

  Diagram& diagram_;
  std::map<std::string, std::size_t> boxes_;
};

std::string any_robot(const std::string& ros) {
  return fmt::format("ROS {}: any robot", ros);
}

Box box_of(const Part& part) {
  Box box;
  box.name = part.name;
  box.kind = part.kind;
  const bool network = part.kind == experiment::kNetwork || experiment::is_simulator(part);
  box.style = network ? BoxStyle::network : BoxStyle::plain;
  if (experiment::has_topic(part.kind)) {
    box.topic = part.parameters.text("topic");
    box.sends = part.kind == experiment::kRosCommand;
  }
  return box;
}

std::string label_of(const Link& link, TimeNs tick) {
  const bool delayed = link.delay_ticks.value_or(0) > 0;
  return fmt::format("[{}{}]", link.width,
                     delayed ? ", delay " + format_time(*link.delay_ticks * tick) : "");
}

Diagram diagram_of(const Experiment& experiment) {
  Diagram diagram;
  diagram.title = experiment.name;
  diagram.frame = fmt::format("one process{}, tick {}, {}",
                              experiment::has_simulator(experiment) ? " and its simulators" : "",
                              format_time(experiment.tick), experiment::name_of(experiment.sync));
  if (experiment.robot) {
    diagram.robot = experiment.robot->bag.empty()
                        ? "robot in MuJoCo"
                        : std::filesystem::path(experiment.robot->bag).filename().string();
    diagram.robot_inside = true;
  } else if (experiment.ros != experiment::Ros::none) {
    diagram.robot = any_robot(experiment::name_of(experiment.ros));
  }
  Builder builder(diagram);
  for (const Part& part : experiment.parts) {
    builder.add(box_of(part));
  }
  for (const Link& link : experiment.links) {
    const bool signal = link.kind == PortKind::signal;
    builder.connect(link.from, link.to, signal ? ArrowStyle::signal : ArrowStyle::spikes,
                    label_of(link, experiment.tick), link.delay_ticks.value_or(0) > 0);
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
  box.style = box.kind == "spikeloop-network" ? BoxStyle::network : BoxStyle::plain;
  const launch::Program* program = launch::find_program(file, section);
  if (program != nullptr && program->ros) {
    const MusicKey* topic = file.find_key(section, program->outside.key);
    box.topic = topic == nullptr ? std::string(program->outside.otherwise) : topic->value;
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

void refuse_structure(const MusicFile& file) {
  const auto problems = find_structure_problems(file);
  if (!problems.empty()) {
    throw ConfigurationError(problems.front().where, problems.front().message);
  }
}

bool is_png(const std::string& path) {
  return path.ends_with(".png");
}

std::string with_ending(const std::string& path, const char* ending) {
  const auto name = path.rfind('/') + 1;
  const auto dot = path.rfind('.');
  return (dot == std::string::npos || dot <= name ? path : path.substr(0, dot)) + ending;
}

void need_converter(const std::string& path) {
  if (launch::find_executable(kConverter, "", launch::program_environment().at("PATH")).empty()) {
    throw TransportError(
        fmt::format("--out: a PNG is drawn by {0}, which is not in PATH; install it (Debian: apt "
                    "install librsvg2-bin), or write  --out {1}",
                    kConverter, with_ending(path, ".svg")));
  }
}

/// Twice as large as the SVG, for screens and slides.
void write_png(const std::string& svg, const std::string& path) {
  const std::string line =
      launch::shell_text({kConverter, "--format=png", "--zoom=2", "--output", path});
  std::FILE* converter = ::popen(line.c_str(), "w");
  const bool written =
      converter != nullptr && std::fwrite(svg.data(), 1, svg.size(), converter) == svg.size();
  const int status = converter == nullptr ? -1 : ::pclose(converter);
  if (!written || status != 0) {
    throw FileError(fmt::format("cannot write '{}': {} has failed; write  --out {}", path,
                                kConverter, with_ending(path, ".svg")));
  }
}

void write_picture(const std::string& svg, const std::string& path) {
  if (path.empty()) {
    put_result(svg);
    return;
  }
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << (is_png(path) ? "" : svg);
  file.close();
  if (!file) {
    throw FileError("write", path, errno == 0 ? EIO : errno);
  }
  if (is_png(path)) {
    write_png(svg, path);
  }
}

int draw(const std::string& path, const std::string& out) {
  if (!out.empty() && !out.ends_with(".svg") && !is_png(out)) {
    throw ConfigurationError(
        fmt::format("--out: '{}' ends neither in .svg nor in .png; write {} "
                    "or {}",
                    out, with_ending(out, ".svg"), with_ending(out, ".png")));
  }
  if (is_png(out)) {
    need_converter(out);
  }
  const auto show = [&](Diagram diagram) {
    lay_out(diagram);
    write_picture(to_svg(diagram), out);
    return 0;
  };
  if (is_experiment(path)) {
    return use_experiment(
        path, [&](const Experiment& experiment) { return show(diagram_of(experiment)); });
  }
  const MusicFile file = read_music_file(path);
  refuse_structure(file);
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
                      "The picture, FILE.svg or FILE.png; else SVG to standard output");
  command->footer(kFooter);
  command->callback([arguments, &action] {
    action = [arguments] { return draw(arguments->file, arguments->out); };
  });
}

}  // namespace spikeloop::app::graph_command
