#include "node_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <vector>

#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/config/parameter_text.hpp"

namespace spikeloop::app {
namespace {

struct Group {
  const char* title;
  const char* text;
  bool spikes_in;
  bool spikes_out;
};

/// Whatever is in no other group is in the last one.
constexpr std::array kGroups{
    Group{"Encoders", "continuous signals in, spikes out", false, true},
    Group{"Decoders", "spikes in, continuous signals out", true, false},
    Group{"Adapters", "signals to signals, spikes to spikes", false, false},
};

constexpr const char* kPageBegin = R"(# Node classes

<!-- Printed by `spikeloop describe --markdown`; a test compares. Do not edit. -->

`spikeloop describe NODE` describes one class, also of plug-ins in `SPIKELOOP_PLUGIN_PATH`.
Parameters are keys of the node or section that runs the class. Experiment files need units
(`30 ms`); in `.music` files the second column is the default unit. The defaults are those of the
class; `PROGRAM --help` prints those of a program with an older name.
)";

bool has_spikes(const NodeDescription& description, Direction direction) {
  return std::ranges::any_of(description.ports, [direction](const PortDescription& port) {
    return port.direction == direction && port.kind == PortKind::spikes;
  });
}

const Group& group_of(const NodeDescription& description) {
  const auto* const found = std::ranges::find_if(kGroups, [&](const Group& group) {
    return group.spikes_in == has_spikes(description, Direction::input) &&
           group.spikes_out == has_spikes(description, Direction::output);
  });
  return found == kGroups.end() ? kGroups.back() : *found;
}

std::vector<const NodeDescription*> members(const Registry& registry, const Group& group) {
  std::vector<const NodeDescription*> found;
  for (const std::string& name : registry.names()) {
    const NodeDescription& description = registry.find(name).description;
    if (&group_of(description) == &group) {
      found.push_back(&description);
    }
  }
  return found;
}

std::string width_text(const NodeDescription& description, const WidthRule& width) {
  switch (width.kind) {
    case WidthRule::Kind::free:
      return "any width";
    case WidthRule::Kind::fixed:
      return fmt::format("{} channel{}", width.value, width.value == 1 ? "" : "s");
    case WidthRule::Kind::same_as:
      return fmt::format("as wide as {}", description.ports[width.value].name);
  }
  return {};
}

std::string port_table(const NodeDescription& description) {
  std::size_t name_width = 0;
  std::size_t rule_width = 0;
  for (const PortDescription& port : description.ports) {
    name_width = std::max(name_width, port.name.size());
    rule_width = std::max(rule_width, width_text(description, port.width).size());
  }
  std::string text;
  for (const PortDescription& port : description.ports) {
    text += fmt::format("  {:<{}}  {:<6}  {:<10}  {:<{}}  {}\n", port.name, name_width,
                        port.direction == Direction::input ? "input" : "output",
                        port.kind == PortKind::signal ? "continuous" : "spikes",
                        width_text(description, port.width), rule_width, port.text);
  }
  return text;
}

}  // namespace

std::string tables(const NodeDescription& description) {
  std::string text = "Ports:\n" + port_table(description);
  if (!description.parameters.empty()) {
    text += "\nParameters:\n" + parameter_text(description.parameters);
  }
  return text;
}

namespace {

std::string how_to_run(const NodeDescription& description) {
  std::vector<std::string> programs;
  for (const NodeProgram& program : node_programs()) {
    if (program.node_class == description.name) {
      programs.emplace_back(program.name);
    }
  }
  return fmt::format(
      "In an experiment: {1}: {{node: {1}}}. In a .music file: {0}binary=spikeloop-node with "
      "node={1}.{2}\n",
      programs.empty() ? "" : fmt::format("binary={}, or ", fmt::join(programs, " or ")),
      description.name,
      description.shareable ? " np processes and threads= in each share its output channels." : "");
}

/// What a table may be written as. One that has no default is too special for the short forms.
std::string table_forms(const NodeDescription& description) {
  std::string text;
  for (const ParameterDescription& parameter : description.parameters) {
    if (parameter.type == ParameterType::weights) {
      text += fmt::format(
          "Write for {} {}a file: JSON, [[0.1, 0.2], [0.3, 0.4]], or what numpy.save wrote "
          "(.npy).\n",
          parameter.name,
          parameter.default_value
              ? "uniform (1 / inputs), uniform:0.01, one_to_one, one_to_one:2, blocks "
                "(means of neighbouring inputs), or "
              : "");
    }
  }
  return text;
}

}  // namespace

std::string class_list(const Registry& registry) {
  std::size_t width = 0;
  for (const std::string& name : registry.names()) {
    width = std::max(width, name.size());
  }
  std::string text;
  for (const Group& group : kGroups) {
    const auto classes = members(registry, group);
    text += classes.empty() ? "" : fmt::format("{}: {}\n", group.title, group.text);
    for (const NodeDescription* description : classes) {
      text += fmt::format("  {:<{}}  {}\n", description->name, width, description->text);
    }
  }
  return text;
}

std::string class_text(const NodeDescription& description) {
  std::string text = fmt::format("{}: {}\n", description.name, description.text);
  if (!description.source.empty()) {
    text += fmt::format("Source: {}\n", description.source);
  }
  text += fmt::format("\n{}\n{}", tables(description), how_to_run(description));
  return text + table_forms(description);
}

std::string reference_page(const Registry& registry) {
  std::string page = kPageBegin;
  for (const Group& group : kGroups) {
    const auto classes = members(registry, group);
    page += classes.empty() ? "" : fmt::format("\n## {}: {}\n", group.title, group.text);
    for (const NodeDescription* description : classes) {
      page += fmt::format("\n### {}\n\n{}.", description->name, description->text);
      page += description->source.empty() ? "" : fmt::format(" Source: {}.", description->source);
      page +=
          fmt::format("\n\n```text\n{}```\n\n{}", tables(*description), how_to_run(*description));
      page += table_forms(*description);
    }
  }
  return page;
}

}  // namespace spikeloop::app
