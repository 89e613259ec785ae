#include "programs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/config/parameter_text.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/nodes/register.hpp"
#include "spikeloop/process/node_program.hpp"

namespace spikeloop {
namespace {

std::string port_lines(const NodeDescription& description) {
  std::string text;
  for (const auto& port : description.ports) {
    text += fmt::format("  {:<10} {:<7} {:<11} {}\n", port.name,
                        port.direction == Direction::input ? "input" : "output",
                        port.kind == PortKind::signal ? "continuous" : "spikes", port.text);
  }
  return text;
}

// Its table is no weights: a grid has two columns an input, and none can be guessed.
bool reads_grid(const NodeDescription& description) {
  return std::ranges::any_of(description.parameters,
                             [](const auto& parameter) { return parameter.name == "grid"; });
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
  if (description.shareable) {
    text.parameters.push_back(music::sharing_parameters().front());
  }
  set_dialect_defaults(text.parameters, program.name, Dialect::rma);
  text.example = example_of(program);
  if (program.table != nullptr) {
    for (ParameterDescription& parameter : text.parameters) {
      if (parameter.name == program.table) {
        parameter.default_value = program.default_table;
      }
    }
  }
  if (program.older_key != nullptr) {
    text.notes = fmt::format("{}=FILE is the older spelling of {}=FILE.\n", program.older_key,
                             program.table);
    text.notes += reads_grid(description) ? ""
                                          : "Without strict=true, a missing or unreadable file is "
                                            "a warning; all weights are 1 / inputs.\n";
  }
  for (const ParameterDescription& parameter : text.parameters) {
    if (const char* older = older_spelling_of(program.name, parameter.name)) {
      text.notes += fmt::format("{} is the older spelling of {}.\n", older, parameter.name);
    }
  }
  if (program.table != nullptr) {
    text.notes +=
        fmt::format("The file of {} is JSON, [[0.1, 0.2], [0.3, 0.4]], or a NumPy array (.npy).\n",
                    program.table);
  }
  text.notes += dialect_note(program.name);
  text.defaults.accept_one_tick = program.accept_one_tick;
  text.defaults.many_processes = true;
  return text;
}

// Takes what stands under an older program's name of `key`.
void take_older_spelling(const music::Process& process, WrittenValues& written,
                         const std::string& key, const char* older_key) {
  const WrittenValues older = older_key == nullptr ? WrittenValues{} : process.written({older_key});
  if (older.empty()) {
    return;
  }
  const WrittenValue& value = older.begin()->second;
  if (written.contains(key)) {
    throw ConfigurationError(
        value.where,
        with_code(Code::duplicate_key,
                  "'{0}' and '{1}' are two spellings of one key; leave out '{1}'", key, older_key));
  }
  written[key] = value;
}

// As the older program: what its keys say, or what it took when nothing was written.
void add_older_keys(const music::Process& process, WrittenValues& written,
                    const std::vector<ParameterDescription>& declared, const NodeProgram& program) {
  for (const ParameterDescription& parameter : declared) {
    take_older_spelling(process, written, parameter.name,
                        older_spelling_of(program.name, parameter.name));
  }
  if (program.table != nullptr) {
    take_older_spelling(process, written, program.table, program.older_key);
    written.try_emplace(program.table, WrittenValue{program.default_table, {}});
  }
}

std::uint32_t width_or_zero(const music::Process& process, const std::string& port) {
  return process.connected_input(port, PortKind::signal) ? process.width(port) : 0;
}

// The weights of linear_decoder cannot be written in an older file.
bool one_to_one_by_default(const NodeProgram* program, const WrittenValues& written) {
  return program != nullptr && program->table != nullptr && program->older_key == nullptr &&
         !written.contains(program->table);
}

WeightLoader table_loader(const music::Process& process, const NodeClass& node_class) {
  WeightOptions options;
  options.base_directory = process.file_directory();
  options.strict = process.common().strict;
  options.rows = width_or_zero(process, "out");
  options.columns = width_or_zero(process, "in");
  if (reads_grid(node_class.description)) {
    options.strict = true;
    options.what = "grid file";
    options.short_forms = false;
    options.columns *= 2;
  }
  return weight_loader(options);
}

/// Beside the .music file, as other files are; else what the system finds under the name.
std::string plugin_path(const music::Process& process, const std::string& written) {
  namespace fs = std::filesystem;
  const fs::path beside = fs::path(process.file_directory()) / written;
  std::error_code error;
  return fs::exists(beside, error) ? beside.string() : written;
}

}  // namespace

void fill_registry(Registry& registry) {
  register_nodes(registry);
  registry.load_plugin_path(plugin_path());
}

music::ProgramText node_program_text(const std::string& name) {
  if (const NodeProgram* program = find_node_program(name)) {
    return text_of(*program);
  }
  music::ProgramText text;
  text.name = "spikeloop-node";
  text.summary = "Runs one node of any class, built in or from a plug-in";
  text.parameters = {
      {.name = "node", .type = ParameterType::text, .text = "Node class; --list prints all"},
      {.name = "plugin",
       .type = ParameterType::text,
       .default_value = "",
       .text = "Plug-in to load, *.so or *.py; those in SPIKELOOP_PLUGIN_PATH are always loaded"},
      {.name = "ports",
       .type = ParameterType::text,
       .default_value = "",
       .text = "Kinds of a plug-in's ports, for the launcher: continuous->spikes"}};
  text.ports = "  those of the class, with the same names\n";
  text.example =
      "  [encoder]\n  binary=spikeloop-node\n  np=1\n  node=rate_encoder\n  rate_max=200\n"
      "  SENDER.out -> encoder.in [100]\n  encoder.out -> RECEIVER.in [100]\n";
  text.notes = "The parameters of the class are also keys of the section.\n";
  text.defaults.many_processes = true;
  text.options["--list"] = {"Print the node classes", class_list};
  return text;
}

const NodeClass& node_class_of(const music::Process& process, Registry& registry) {
  fill_registry(registry);
  if (const NodeProgram* program = find_node_program(process.program())) {
    return registry.find(program->node_class);
  }
  const auto keys = process.read(node_program_text("").parameters);
  if (!keys.text("plugin").empty()) {
    const std::string path = plugin_path(process, keys.text("plugin"));
    located_at(keys.where("plugin"), [&] {
      require_code_may_run(fmt::format("plug-in '{}'", keys.text("plugin")));
      return registry.load_plugin(path);
    });
  }
  return *located_at(keys.where("node"), [&] { return &registry.find(keys.text("node")); });
}

Parameters node_parameters(music::Process& process, const NodeClass& node_class) {
  auto declared = node_class.description.parameters;
  const auto& keys = process.common();
  WrittenValues written = process.written(names_of(declared));
  const NodeProgram* program = find_node_program(process.program());
  WeightLoader load_table = table_loader(process, node_class);
  if (one_to_one_by_default(program, written)) {
    auto uneven =
        uneven_one_to_one(width_or_zero(process, "in"), width_or_zero(process, "out"), keys.strict);
    if (uneven) {
      load_table = [table = std::move(*uneven)](const WrittenValue&) { return table; };
    }
  }
  if (program != nullptr) {
    set_dialect_defaults(declared, program->name, keys.dialect);
    process.written(ignored_keys(program->name));  // so that they are known
    add_older_keys(process, written, declared, *program);
  }
  return resolve(declared, written, load_table);
}

}  // namespace spikeloop
