#include "spikeloop/config/older_programs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/log.hpp"

namespace spikeloop {
namespace {

constexpr NodeProgram kNodePrograms[] = {
    {"connect_adapter", "connect", "weights", "weights_filename", "connection_weights.dat", false,
     "  weights=halves.json\n"},
    {"cont_cont_adapter", "connect", "weights", "weights_filename", "weights.json", false,
     "  weights=halves.json\n"},
    {"threshold_adapter", "threshold", nullptr, nullptr, nullptr, false, "  threshold=0.5\n"},
    {"sigmoid_adapter", "sigmoid", nullptr, nullptr, nullptr, false, "  slope=4\n"},
    {"argmax_adapter", "argmax", nullptr, nullptr, nullptr, false, ""},
    {"discretize_adapter", "discretize", "grid", "grid_positions_filename", "grid_positions.json",
     false, "  grid=places.json\n"},
    {"rate_encoder", "rate_encoder", nullptr, nullptr, nullptr, false,
     "  rate_min=1\n  rate_max=200\n"},
    {"poisson_encoder", "poisson_encoder", nullptr, nullptr, nullptr, false,
     "  rate_min=1\n  rate_max=200\n"},
    {"nef_encoder", "nef_encoder", nullptr, nullptr, nullptr, false, "  gain_max=200\n"},
    {"linear_readout_decoder", "linear_readout", "weights", "weights_filename",
     "readout_weights.dat", true, "  tau=0.03\n  weights=readout.json\n"},
    {"linear_decoder", "linear_readout", "weights", nullptr, "one_to_one", false, "  tau=0.03\n"},
};

constexpr RosProgram kRosPrograms[] = {
    {.name = "ros_sensor_adapter", .node_class = "ros_sensor", .node_name = "ros_sensor_node"},
    {.name = "ros_cont_adapter", .node_class = "ros_sensor", .node_name = "ros_sensor_node"},
    {.name = "ros_event_sensor_adapter",
     .node_class = "ros_event_sensor",
     .node_name = "ros_event_sensor_node",
     .message = "dvs_msgs/EventArray"},
    {.name = "ros_command_adapter",
     .node_class = "ros_command",
     .node_name = "ros_command_node",
     .command_rate = "10"},
    {.name = "cont_ros_adapter",
     .node_class = "ros_command",
     .node_name = "cmd_out",
     .topic = "/cmd_vel",
     .command_rate = "20",
     .command_rate_key = "command_update_rate",
     .mapping_file = "mapping.json"},
};

struct DialectDefault {
  std::string_view program;
  std::string_view key;
  const char* rma;
  const char* ma;
};

constexpr DialectDefault kDefaults[] = {
    {"nef_encoder", "preset", "rma", "ma"},
};

constexpr const char* kClockMaster = "clock_master";
constexpr const char* kDataStamp = "data_stamp";
constexpr const char* kPace = "pace";  // meant both in earlier versions

void rename_clock_master(std::vector<MusicKey>& keys) {
  for (MusicKey& key : keys) {
    if (key.name != kPace || (key.value != "true" && key.value != "false")) {
      continue;
    }
    if (find_key(keys, kClockMaster) != nullptr) {
      throw ConfigurationError(
          key.where, with_code(Code::duplicate_key,
                               "'{0}' and '{1}' are two spellings of one key; leave out '{1}'",
                               kClockMaster, kPace));
    }
    key.name = kClockMaster;
  }
}

void rename_data_stamp(const MusicFile& file, const std::string& label, std::string& port) {
  const MusicSection* section = port == kPace ? file.find_section(label) : nullptr;
  if (section != nullptr && earlier_port(program_of(*section), kDataStamp) != nullptr) {
    port = kDataStamp;
  }
}

}  // namespace

std::span<const NodeProgram> node_programs() {
  return kNodePrograms;
}

const NodeProgram* find_node_program(std::string_view name) {
  for (const auto& program : kNodePrograms) {
    if (name == program.name) {
      return &program;
    }
  }
  return nullptr;
}

const RosProgram* find_ros_program(std::string_view name) {
  const auto* const found = std::ranges::find(kRosPrograms, name, &RosProgram::name);
  return found == std::end(kRosPrograms) ? nullptr : found;
}

void set_dialect_defaults(std::vector<ParameterDescription>& declared, std::string_view program,
                          Dialect dialect) {
  for (const DialectDefault& entry : kDefaults) {
    const auto parameter = std::ranges::find(declared, entry.key, &ParameterDescription::name);
    if (entry.program == program && parameter != declared.end()) {
      parameter->default_value = dialect == Dialect::ma ? entry.ma : entry.rma;
    }
  }
}

std::string dialect_note(std::string_view program) {
  std::string text;
  for (const DialectDefault& entry : kDefaults) {
    if (entry.program == program && std::string_view(entry.rma) != entry.ma) {
      text += fmt::format("{}{}={}", text.empty() ? "" : ", ", entry.key, entry.ma);
    }
  }
  return text.empty() ? "" : fmt::format("Defaults in dialect ma: {}.\n", text);
}

std::vector<std::string> ignored_keys(std::string_view program) {
  // Its rates follow from the neurons.
  return program == "nef_encoder" ? std::vector<std::string>{"rate_min", "rate_max"}
                                  : std::vector<std::string>{};
}

const char* older_spelling_of(std::string_view program, std::string_view key) {
  return program == "nef_encoder" && key == "resolution" ? "neuron_resolution" : nullptr;
}

const char* earlier_key(std::string_view key) {
  return key == kClockMaster ? kPace : nullptr;
}

const char* earlier_port(std::string_view program, std::string_view port) {
  return port == kDataStamp && find_ros_program(program) != nullptr ? kPace : nullptr;
}

MusicFile with_present_names(MusicFile file) {
  rename_clock_master(file.globals);
  for (MusicSection& section : file.sections) {
    rename_clock_master(section.keys);
  }
  for (MusicConnection& connection : file.connections) {
    rename_data_stamp(file, connection.from_app, connection.from_port);
    rename_data_stamp(file, connection.to_app, connection.to_port);
  }
  return file;
}

std::optional<WeightTable> uneven_one_to_one(std::uint32_t inputs, std::uint32_t outputs,
                                             bool strict) {
  if (inputs == outputs) {
    return std::nullopt;
  }
  const std::uint32_t common = std::min(inputs, outputs);
  const std::string widths =
      fmt::format("port 'in' has {} channels and port 'out' {}", inputs, outputs);
  if (strict) {
    throw ConfigurationError(
        with_code(Code::widths_differ, "{}; make both connections equally wide", widths));
  }
  log::warning("{}: {} from channel {} on {}; make both connections equally wide", widths,
               inputs < outputs ? "outputs" : "inputs", common,
               inputs < outputs ? "stay 0" : "are left out");
  WeightTable table;
  table.kind = WeightTable::Kind::sparse;
  table.rows = outputs;
  table.columns = inputs;
  for (std::uint32_t row = 0; row <= outputs; ++row) {
    table.row_start.push_back(std::min(row, common));
  }
  for (std::uint32_t channel = 0; channel < common; ++channel) {
    table.column.push_back(channel);
    table.values.push_back(1.0);
  }
  return table;
}

}  // namespace spikeloop
