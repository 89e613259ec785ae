#include "programs.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "spikeloop/config/parameter_text.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop {
namespace {

constexpr NodeProgram kPrograms[] = {
    {"connect_adapter", "connect", "weights_filename", "connection_weights.dat", false,
     "  weights=halves.json\n"},
    {"rate_encoder", "rate_encoder", nullptr, nullptr, false, "  rate_min=1\n  rate_max=200\n"},
    {"poisson_encoder", "poisson_encoder", nullptr, nullptr, false,
     "  rate_min=1\n  rate_max=200\n"},
    {"linear_readout_decoder", "linear_readout", "weights_filename", "readout_weights.dat", true,
     "  tau=0.03\n  weights=readout.json\n"},
};

std::string port_lines(const NodeDescription& description) {
  std::string text;
  for (const auto& port : description.ports) {
    text += fmt::format("  {:<10} {:<7} {:<11} {}\n", port.name,
                        port.direction == Direction::input ? "input" : "output",
                        port.kind == PortKind::signal ? "continuous" : "spikes", port.text);
  }
  return text;
}

std::string example_of(const NodeProgram& program) {
  return fmt::format(
      "  stoptime=10\n  [{0}]\n  binary={0}\n  np=1\n{1}  SENDER.out -> {0}.in [100]\n  {0}.out -> "
      "RECEIVER.in [100]\n",
      program.name, program.example);
}

std::string class_list() {
  Registry registry;
  fill_registry(registry);
  std::string text;
  for (const auto& name : registry.names()) {
    text += fmt::format("{:<18} {}\n", name, registry.find(name).description.text);
  }
  return text;
}

music::ProgramText text_of(const NodeProgram& program) {
  Registry registry;
  register_nodes(registry);
  const auto& description = registry.find(program.node_class).description;
  music::ProgramText text;
  text.name = program.name;
  text.summary = description.text;
  text.ports = port_lines(description);
  text.parameters = description.parameters;
  text.example = example_of(program);
  if (program.weights_key != nullptr) {
    text.notes = fmt::format(
        "{}=FILE is the older spelling of weights=FILE. With neither, dialect rma reads {}; "
        "unless\n"
        "strict=true, a file that is missing or not readable gives 1 / inputs, with a warning.\n",
        program.weights_key, program.weights_file);
  }
  text.defaults.accept_one_tick = program.accept_one_tick;
  return text;
}

// The older programs' key, or the file they read when nothing is written.
void add_older_spelling(WrittenValues& written, const WrittenValues& older,
                        const NodeProgram& program, music::Dialect dialect) {
  const auto found = older.find(program.weights_key);
  if (found == older.end()) {
    if (!written.contains("weights") && dialect == music::Dialect::rma) {
      written["weights"] = {program.weights_file, {}};
    }
    return;
  }
  if (written.contains("weights")) {
    throw ConfigurationError(
        found->second.where,
        fmt::format("'weights' and '{0}' are two spellings of one key; leave out '{0}'",
                    program.weights_key));
  }
  written["weights"] = found->second;
}

std::uint32_t width_or_zero(const music::Process& process, const std::string& port) {
  return process.connected_input(port, PortKind::signal) ? process.width(port) : 0;
}

}  // namespace

const NodeProgram* find_node_program(std::string_view name) {
  for (const auto& program : kPrograms) {
    if (name == program.name) {
      return &program;
    }
  }
  return nullptr;
}

void fill_registry(Registry& registry) {
  register_nodes(registry);
  if (const char* directories = std::getenv("SPIKELOOP_PLUGIN_PATH"); directories != nullptr) {
    registry.load_plugin_path(directories);
  }
}

music::ProgramText node_program_text(const std::string& name) {
  if (const NodeProgram* program = find_node_program(name)) {
    return text_of(*program);
  }
  music::ProgramText text;
  text.name = "spikeloop-node";
  text.summary = "Runs one node of any class, built in or from a plug-in";
  text.parameters = {
      {.name = "node", .type = ParameterType::text, .text = "Class of the node; --list shows them"},
      {.name = "plugin",
       .type = ParameterType::text,
       .default_value = "",
       .text = "A plug-in to load first; those in SPIKELOOP_PLUGIN_PATH are always loaded"}};
  text.ports = "  those of the class, under the same names\n";
  text.example =
      "  [encoder]\n  binary=spikeloop-node\n  np=1\n  node=rate_encoder\n  rate_max=200\n"
      "  SENDER.out -> encoder.in [100]\n  encoder.out -> RECEIVER.in [100]\n";
  text.notes = "The class's own parameters are keys of the section as well.\n";
  text.options["--list"] = {"the node classes", class_list};
  return text;
}

const NodeClass& node_class_of(const music::Process& process, Registry& registry) {
  fill_registry(registry);
  if (const NodeProgram* program = find_node_program(process.program())) {
    return registry.find(program->node_class);
  }
  const auto keys = process.read(node_program_text("").parameters);
  if (!keys.text("plugin").empty()) {
    registry.load_plugin(keys.text("plugin"));
  }
  try {
    return registry.find(keys.text("node"));
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(keys.where("node"), fmt::format("key 'node': {}", error.what()));
  }
}

Parameters node_parameters(music::Process& process, const NodeClass& node_class) {
  const auto& declared = node_class.description.parameters;
  std::vector<std::string> names;
  for (const auto& parameter : declared) {
    names.push_back(parameter.name);
  }
  const auto& keys = process.common();
  WrittenValues written = process.written(names);
  if (const NodeProgram* program = find_node_program(process.program());
      program != nullptr && program->weights_key != nullptr) {
    add_older_spelling(written, process.written({program->weights_key}), *program, keys.dialect);
  }
  WeightOptions options;
  options.base_directory = process.file_directory();
  options.strict = keys.strict;
  options.rows = width_or_zero(process, "out");
  options.columns = width_or_zero(process, "in");
  return resolve(declared, written, weight_loader(options));
}

}  // namespace spikeloop
