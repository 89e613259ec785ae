#include "node_import.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "spikeloop/command/mapping.hpp"
#include "spikeloop/config/data_file.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/config/message_type.hpp"
#include "spikeloop/config/network_script.hpp"
#include "spikeloop/config/sensor_mapping_file.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::app {
namespace {

namespace fs = std::filesystem;

/// Of more numbers a table does not stand in the experiment.
constexpr std::uint64_t kMostInPlace = 20'000;

/// What a process needs and an experiment does not, or says once for all.
constexpr std::string_view kOfProcesses =
    " np binary wd args barrier strict clock_master rtf stoptime music_timestep seed dialect sync "
    "record on_write_failure stamp_guard accept_latency signal_delay spike_delay threads ports "
    "spikes_in "
    "spikes_out signals_in signals_out verbose pipeline_ticks host ros ros_arguments "
    "ros_node_name sensor_update_rate master_timeout ";

bool is_short_form(const std::string& text) {
  const std::string name = text.substr(0, text.find(':'));
  return name == "uniform" || name == "one_to_one" || name == "blocks" || name == "even";
}

std::string field_text(const CommandField& field) {
  std::string text = fmt::format("channel: {}", field.channel);
  const auto add = [&text](const char* name, double value) {
    text += fmt::format(", {}: {}", name, value);
  };
  if (field.scale != 1) {
    add("scale", field.scale);
  }
  if (field.offset != 0) {
    add("offset", field.offset);
  }
  if (field.minimum) {
    add("min", *field.minimum);
  }
  if (field.maximum) {
    add("max", *field.maximum);
  }
  if (field.slew) {
    add("slew", *field.slew);
  }
  if (field.stop) {
    text += fmt::format(", stop: {}", stop_text(*field.stop));
  }
  return fmt::format("\n      {}: {{{}}}", field.field, text);
}

}  // namespace

/// An experiment has such nodes, but their answers take a tick more in its one process: other
/// spikes than the job's.
void NodeImporter::refuse_script(const MusicSection& section,
                                 const launch::Program* program) const {
  if (program != nullptr && program->script) {
    const std::string script = launch::what_runs(file_, section);
    throw ConfigurationError(
        section.where,
        with_code(Code::script,
                  "[{0}] runs the script {1}, whose delays are others in an experiment; write  "
                  "{0}: {{simulator: python, script: {1}}}  into one by hand "
                  "(docs/simulators.md), or keep  spikeloop run {2}",
                  section.label, script, fs::path(file_.path).filename().string()));
  }
}

ImportedNode NodeImporter::import(const MusicSection& section) {
  node_ = {};
  used_.clear();
  node_.name = section.label;
  const std::string program = program_of(section);
  const RosProgram* ros = find_ros_program(program);
  const NodeProgram* older = find_node_program(program);
  if (ros != nullptr) {
    import_topic(section, *ros);
  } else if (older != nullptr || program == "spikeloop-node") {
    import_class(section, older);
  } else if (program == "spikeloop-network") {
    import_network(section);
  } else if (program == experiment::kSpikePlayback || program == experiment::kSignalPlayback) {
    import_playback(section);
  } else {
    const launch::Program* known = launch::find_program(file_, section);
    refuse_script(section, known);
    const bool ours = known != nullptr;
    throw ConfigurationError(
        section.where,
        with_code(Code::program, "[{}] runs {}, {}; keep  spikeloop run {}", section.label, program,
                  ours ? "which no node of an experiment does"
                       : "which is none of Spikeloop's programs: an experiment cannot start it",
                  fs::path(file_.path).filename().string()));
  }
  note_unused_keys(section);
  return std::move(node_);
}

void NodeImporter::add(const std::string& key, const std::string& yaml) {
  node_.keys.emplace_back(key, yaml);
}

const MusicKey* NodeImporter::find(const MusicSection& section, std::string_view name) {
  used_.emplace_back(name);
  return file_.find_key(section, name);
}

std::string NodeImporter::required(const MusicSection& section, const char* key,
                                   const char* example) {
  const MusicKey* found = find(section, key);
  if (found == nullptr || found->value.empty()) {
    throw ConfigurationError(section.where,
                             with_code(Code::missing_key, "section '{}' has no {}; write {}={}",
                                       section.label, key, key, example));
  }
  return found->value;
}

bool NodeImporter::strict(const MusicSection& section) const {
  const MusicKey* key = file_.find_key(section, "strict");
  return key != nullptr && (key->value == "true" || key->value == "1");
}

Dialect NodeImporter::dialect(const MusicSection& section) const {
  const MusicKey* key = file_.find_key(section, "dialect");
  return located_at(key == nullptr ? section.where : key->where, [&] {
    return dialect_named(key == nullptr ? "" : key->value, programs_of(file_));
  });
}

std::uint32_t NodeImporter::width(const MusicSection& section, std::string_view port) const {
  for (const MusicConnection& connection : file_.connections) {
    const bool to = connection.to_app == section.label && connection.to_port == port;
    const bool from = connection.from_app == section.label && connection.from_port == port;
    if ((to || from) && connection.width) {
      return *connection.width;
    }
  }
  return 0;
}

/// Where a file lies, seen from the experiment.
std::string NodeImporter::path(const MusicSection& section, const std::string& written,
                               const Location& where, const char* what, const std::string& behind) {
  const std::string base = launch::directory_of(file_.path);
  auto found = find_data_file(written, base);
  if (!found) {
    found = find_data_file(written, launch::working_directory(file_, section, base));
  }
  if (!found) {
    throw ConfigurationError(
        where, with_code(Code::missing_file, "there is no {} '{}' in '{}'; write its path", what,
                         written, fs::absolute(base).lexically_normal().string()));
  }
  return yaml_text((fs::path(written).is_absolute()
                        ? written
                        : fs::proximate(fs::absolute(*found), options_.directory).string()) +
                   behind);
}

/// The section's keys are parameters of the class, and stand in its order.
void NodeImporter::import_topic(const MusicSection& section, const RosProgram& program) {
  node_.description = &types_.find(program.node_class).description;
  add("node", program.node_class);
  const auto keys = experiment::section_keys(program.node_class);
  const auto declared = experiment::section_parameters(program);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i].inner.empty()) {
      add_topic_key(section, program, keys[i], declared[i]);
    }
    if (keys[i].parameter == "topic" && node_.description->name == experiment::kRosCommand) {
      add_fields(section, program);
    }
  }
  add_maps(section, keys, declared);
  if (node_.description->name == experiment::kRosSensor) {
    add_mapping_file(section);
  }
  note_differences(section);
}

void NodeImporter::add_topic_key(const MusicSection& section, const RosProgram& program,
                                 const experiment::SectionKey& key,
                                 const ParameterDescription& declared) {
  const MusicKey* written = find(section, key.name);
  if (key.parameter == "command_rate") {
    written = command_rate(section, program);
  }
  const std::string name(key.parameter);
  const bool empty = written != nullptr && written->value.empty();
  const bool needed = name == "topic" || name == "message";
  if ((written == nullptr && !declared.default_value) || (empty && needed)) {
    throw ConfigurationError(section.where, missing_key(declared, "="));
  }
  if (empty && declared.type == ParameterType::list) {
    return;
  }
  const auto of_class =
      std::ranges::find(node_.description->parameters, key.parameter, &ParameterDescription::name);
  if (written == nullptr && declared.default_value == of_class->default_value) {
    return;  // the class's own default
  }
  const std::string& text = written == nullptr ? *declared.default_value : written->value;
  const Location& where = written == nullptr ? section.where : written->where;
  if (name == "message" && is_definition_file(text)) {
    add(name, path(section, text, where, "message definition"));
  } else if (name == "message") {
    add(name, yaml_text(message_type(section, text, where)));
  } else {
    add(name, yaml_value(declared, text, where));
  }
}

/// With its package. One that is not installed here stays as it is: whoever runs it may have it.
std::string NodeImporter::message_type(const MusicSection& section, const std::string& text,
                                       const Location& where) const {
  const auto ros =
      launch::ros_version(file_, section) == 2 ? messages::Dialect::ros2 : messages::Dialect::ros1;
  try {
    return experiment::whole_message_type(text, launch::directory_of(file_.path), ros);
  } catch (const ConfigurationError& error) {
    if (text.find('/') != std::string::npos) {
      return text;
    }
    throw_located(error, where);
  }
}

/// Each family had one of the two spellings.
const MusicKey* NodeImporter::command_rate(const MusicSection& section, const RosProgram& program) {
  const MusicKey* rate = find(section, program.command_rate_key);
  for (const char* other : {"command_rate", "command_update_rate"}) {
    const MusicKey* key = find(section, other);
    rate = rate == nullptr ? key : rate;
  }
  return rate;
}

/// `emergency_stop_timeout` is `timeout` in `emergency_stop`.
void NodeImporter::add_maps(const MusicSection& section,
                            std::span<const experiment::SectionKey> keys,
                            const std::vector<ParameterDescription>& declared) {
  std::map<std::string, std::vector<std::string>> maps;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const MusicKey* written = keys[i].inner.empty() ? nullptr : find(section, keys[i].name);
    if (written != nullptr && !written->value.empty()) {
      maps[std::string(keys[i].parameter)].push_back(fmt::format(
          "{}: {}", keys[i].inner, yaml_value(declared[i], written->value, written->where)));
    }
  }
  for (const auto& [name, entries] : maps) {
    add(name, fmt::format("{{{}}}", fmt::join(entries, ", ")));
  }
}

/// The file has the keys `fields` and `image` of the node.
void NodeImporter::add_mapping_file(const MusicSection& section) {
  const MusicKey* file = find(section, "sensor_mapping_filename");
  if (file == nullptr) {
    return;
  }
  const WrittenValues keys = located_at(file->where, [&] {
    return read_sensor_mapping(file->value, launch::directory_of(file_.path));
  });
  for (const auto& [name, value] : keys) {
    add(name, value.text.starts_with('[') || value.text.starts_with('{') ? value.text
                                                                         : yaml_quoted(value.text));
  }
}

void NodeImporter::note_differences(const MusicSection& section) {
  if (node_.description->name == experiment::kRosCommand &&
      find(section, "sensor_topics") != nullptr) {
    note(section.where, fmt::format("'{}': an experiment watches the sensors on the way to a "
                                    "command itself; write timeout into those of sensor_topics",
                                    section.label));
  }
}

void NodeImporter::add_fields(const MusicSection& section, const RosProgram& program) {
  const MusicKey* key = find(section, "message_mapping_filename");
  find(section, "message_type");  // the mapping file decides
  const std::string name = key == nullptr ? program.mapping_file : key->value;
  const Location where = key == nullptr ? section.where : key->where;
  if (name.empty()) {
    add("message", "std_msgs/Float64MultiArray");
    return;
  }
  const CommandMapping mapping = located_at(where, [&] {
    return read_mapping(name, {.base_directory = launch::directory_of(file_.path),
                               .strict = strict(section),
                               .named_in = where});
  });
  add("message", mapping.message_type);
  if (mapping.all_channels) {
    if (mapping.stop) {
      add("stop", mapping.stop->hold ? "hold" : "zero");
    }
    return;
  }
  if (mapping.fields.empty()) {
    throw ConfigurationError(
        where, with_code(Code::fields_differ,
                         "the mapping '{}' has no field: all that it sends is 0; map a field, as "
                         "{{\"mapping\": {{\"linear.x\": 0}}}}",
                         name));
  }
  std::string fields;
  for (const CommandField& field : mapping.fields) {
    fields += field_text(field);
  }
  add("fields", fields);
  const MusicKey* limits = find(section, "default_limits");
  const bool without =
      !std::ranges::equal(command::bounds(mapping, 0, false), command::bounds(mapping, 0, true), {},
                          &command::Bounds::maximum, &command::Bounds::maximum);
  if (without && (limits == nullptr || limits->value != "true")) {
    add("limits", experiment::kNoLimits);
  }
}

void NodeImporter::load_plugin(const MusicSection& section, const MusicKey& key) {
  node_.plugin = path(section, key.value, key.where, "plug-in");
  const fs::path absolute = (options_.directory / fs::path(node_.plugin)).lexically_normal();
  located_at(key.where, [&] { types_.load_plugin(absolute.string()); });
}

void NodeImporter::import_class(const MusicSection& section, const NodeProgram* program) {
  std::string name = program == nullptr ? required(section, "node", "rate_encoder")
                                        : std::string(program->node_class);
  if (const MusicKey* plugin = program == nullptr ? find(section, "plugin") : nullptr) {
    load_plugin(section, *plugin);
  }
  const Location where = program != nullptr ? section.where : find(section, "node")->where;
  const NodeClass& node_class = *located_at(where, [&] { return &types_.find(name); });
  node_.description = &node_class.description;
  add("node", name);
  auto declared = node_class.description.parameters;
  if (program != nullptr) {
    set_dialect_defaults(declared, program->name, dialect(section));
    for (const std::string& key : ignored_keys(program->name)) {
      used_.push_back(key);
    }
  }
  for (std::size_t i = 0; i < declared.size(); ++i) {
    const auto& own = node_class.description.parameters[i].default_value;
    const MusicKey* key = find(section, declared[i].name);
    if (key == nullptr && declared[i].default_value != own && declared[i].default_value) {
      add(declared[i].name, with_unit(*declared[i].default_value, declared[i].unit));
    } else {
      add_parameter(section, program, declared[i]);
    }
  }
}

void NodeImporter::add_parameter(const MusicSection& section, const NodeProgram* program,
                                 const ParameterDescription& parameter) {
  const MusicKey* key = find(section, parameter.name);
  if (key == nullptr && program != nullptr) {
    const char* older = older_spelling_of(program->name, parameter.name);
    const bool is_table = program->table != nullptr && parameter.name == program->table;
    older = older == nullptr && is_table ? program->older_key : older;
    key = older == nullptr ? nullptr : find(section, older);
    if (key == nullptr && is_table) {
      add(parameter.name,
          table(section, program->default_table, section.where, parameter.name == "grid"));
      return;
    }
  }
  if (key == nullptr) {
    return;  // the class's own default
  }
  if (parameter.type == ParameterType::weights) {
    add(parameter.name, table(section, key->value, key->where, parameter.name == "grid"));
  } else {
    add(parameter.name, yaml_value(parameter, key->value, key->where));
  }
}

/// A file that fits stays a file; what the older programs made of others stands in place.
std::string NodeImporter::table(const MusicSection& section, const std::string& written,
                                const Location& where, bool grid) {
  const std::string base = launch::directory_of(file_.path);
  const std::uint32_t inputs = width(section, "in");
  const std::uint32_t outputs = width(section, "out");
  if (!grid && is_short_form(written) && !find_data_file(written, base)) {
    if (program_of(section) == "linear_decoder" && written == "one_to_one" && inputs != outputs) {
      const auto uneven = uneven_one_to_one(inputs, outputs, strict(section));
      return uneven ? yaml_table(*uneven) : written;
    }
    return yaml_text(written);
  }
  if (grid || strict(section)) {
    return path(section, written, where, grid ? "grid file" : "weights file");
  }
  try {
    const WeightTable exact = read_weights(written, {.base_directory = base, .short_forms = false});
    if (exact.rows == outputs && exact.columns == inputs) {
      return path(section, written, where, "weights file");
    }
  } catch (const Error&) {
    // What the program makes of it stands in place.
  }
  return fitted_table(section, written, where);
}

std::string NodeImporter::fitted_table(const MusicSection& section, const std::string& written,
                                       const Location& where) {
  const WeightTable fitted =
      read_weights(written, {.base_directory = launch::directory_of(file_.path),
                             .strict = false,
                             .rows = width(section, "out"),
                             .columns = width(section, "in"),
                             .short_forms = false,
                             .named_in = where});
  if (fitted.values.size() > kMostInPlace) {
    throw ConfigurationError(
        where, with_code(Code::weights_differ,
                         "the weights '{}' do not fit the ports and have too many numbers to "
                         "stand in an experiment; make them [{}, {}]",
                         written, width(section, "out"), width(section, "in")));
  }
  return yaml_table(fitted);
}

void NodeImporter::import_network(const MusicSection& section) {
  node_.description = &types_.find(experiment::kNetwork).description;
  add("simulator", "builtin");
  const std::string name = required(section, "network", "brain.yaml");
  const std::string file = network_source(name);
  add("network", path(section, file, find(section, "network")->where, "network file",
                      name.substr(file.size())));
  if (is_network_script(name)) {  // arguments of its function
    for (const MusicKey& key : section.keys) {
      if (is_unused(key)) {
        add(key.name, yaml_text(find(section, key.name)->value));
      }
    }
  }
}

void NodeImporter::import_playback(const MusicSection& section) {
  const std::string kind = program_of(section);
  node_.description = &types_.find(kind).description;
  add("node", kind);
  const std::string name = required(section, "file", "run1/encoder.h5");
  add("file", path(section, name, find(section, "file")->where, "recording"));
  if (const MusicKey* stream = find(section, "stream")) {
    add("stream", yaml_text(stream->value));
  }
}

bool NodeImporter::is_unused(const MusicKey& key) const {
  return std::ranges::find(used_, key.name) == used_.end() &&
         kOfProcesses.find(" " + key.name + " ") == std::string_view::npos;
}

void NodeImporter::note_unused_keys(const MusicSection& section) {
  for (const MusicKey& key : section.keys) {
    if (is_unused(key)) {
      note(key.where,
           fmt::format("key '{}' has no counterpart in an experiment and is left out", key.name));
    }
  }
}

}  // namespace spikeloop::app
