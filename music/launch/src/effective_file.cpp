#include "spikeloop/launch/effective_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "cycles.hpp"
#include "spikeloop/config/dialect.hpp"
#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/config/order.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::launch {
namespace {

constexpr TimeNs kDefaultTick = 1'000'000;
constexpr const char* kDataStampPort = "data_stamp";

/// The text a program reads back as the same number.
std::string seconds_text(TimeNs time) {
  return fmt::format("{}", to_seconds(time));
}

void set_everywhere(MusicFile& file, const char* name, const std::string& value) {
  std::erase_if(file.globals, [name](const MusicKey& key) { return key.name == name; });
  set_key(file.globals, name, value);  // it stands nowhere in the file
  for (MusicSection& section : file.sections) {
    std::erase_if(section.keys, [name](const MusicKey& key) { return key.name == name; });
  }
}

/// Adds a key that neither the section nor the file's global part has.
void add_key(const MusicFile& file, MusicSection& section, const char* name,
             const std::string& value) {
  if (file.find_key(section, name) == nullptr) {
    set_key(section.keys, name, value);
  }
}

void apply_options(MusicFile& file, const RunOptions& options) {
  if (options.duration_s) {
    set_everywhere(file, "stoptime", fmt::format("{}", *options.duration_s));
  }
  if (options.seed) {
    set_everywhere(file, "seed", fmt::format("{}", *options.seed));
  }
  if (options.real_time_factor) {
    set_everywhere(file, "rtf", fmt::format("{}", *options.real_time_factor));
  }
  if (options.strict) {
    set_everywhere(file, "strict", "true");
  }
  for (MusicSection& section : file.sections) {
    if (options.ros && ros_version(file, section) != 0) {
      set_key(section.keys, "ros", fmt::format("{}", *options.ros));
    }
    if (!options.ros_arguments.empty() && ros_version(file, section) != 0) {
      set_key(section.keys, "ros_arguments", options.ros_arguments);
    }
    if (options.record && find_program(file, section) != nullptr) {
      set_key(section.keys, "record", "true");
    }
  }
}

bool is_word(const std::string& text) {
  return std::ranges::all_of(text,
                             [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

/// Nodes of ROS 2 with the same default name get their sections' names, too, where a name may have
/// them. Over ROS 1 every default name gets a suffix anyway.
void set_node_names(MusicFile& file) {
  constexpr const char* kNodeName = "ros_node_name";
  std::map<std::string, std::vector<MusicSection*>> nodes;  // by their names
  for (MusicSection& section : file.sections) {
    const Program* program = find_program(file, section);
    if (program != nullptr && ros_version(file, section) == 2 &&
        file.find_key(section, kNodeName) == nullptr) {
      if (const RosProgram* ros = find_ros_program(program->name)) {
        nodes[ros->node_name].push_back(&section);
      }
    }
  }
  for (const auto& [name, sections] : nodes) {
    for (MusicSection* section : sections) {
      if (sections.size() > 1 && is_word(section->label)) {
        set_key(section->keys, kNodeName, fmt::format("{}_{}", name, section->label));
      }
    }
  }
}

Dialect dialect_of(const MusicFile& file, const MusicSection& section) {
  const MusicKey* key = file.find_key(section, "dialect");
  return located_at(key == nullptr ? section.where : key->where, [&] {
    return dialect_named(key == nullptr ? "" : key->value, programs_of(file));
  });
}

/// What our programs of dialect ma take for themselves; written here, the launcher knows it too.
void set_stoptimes(MusicFile& file) {
  for (MusicSection& section : file.sections) {
    if (find_program(file, section) != nullptr && dialect_of(file, section) == Dialect::ma) {
      add_key(file, section, "stoptime", fmt::format("{}", kStoptimeOfMa_s));
    }
  }
}

IsContinuous continuity(const MusicFile& file) {
  return [&file](const MusicConnection& connection) { return is_continuous(file, connection); };
}

/// The first ros_sensor_adapter from which data come to `label`; null when none does.
const MusicSection* first_source_of(const MusicFile& file, const std::string& label) {
  for (const MusicSection& section : file.sections) {
    const Program* program = find_program(file, section);
    if (program != nullptr && program->tells_age &&
        data_path(file, section.label, label, continuity(file))) {
      return &section;
    }
  }
  return nullptr;
}

bool has_data_stamp(const MusicFile& file, const std::string& label) {
  return std::any_of(file.connections.begin(), file.connections.end(), [&](const auto& connection) {
    return connection.to_app == label && connection.to_port == kDataStampPort;
  });
}

std::vector<std::string> age_measuring(const MusicFile& file) {
  std::vector<std::string> labels;
  for (const MusicSection& section : file.sections) {
    const Program* program = find_program(file, section);
    if (program != nullptr && program->measures_age) {
      labels.push_back(section.label);
    }
  }
  return labels;
}

void add_data_stamp_connections(MusicFile& file) {
  std::vector<MusicConnection> added;
  for (const std::string& label : age_measuring(file)) {
    const MusicSection* source = first_source_of(file, label);
    if (source != nullptr && !has_data_stamp(file, label)) {
      MusicConnection connection;
      connection.from_app = source->label;
      connection.from_port = kDataStampPort;
      connection.to_app = label;
      connection.to_port = kDataStampPort;
      connection.width = 1;
      added.push_back(connection);
    }
  }
  file.connections.insert(file.connections.end(), added.begin(), added.end());
}

/// The data's way, without the data_stamp connections beside it.
MusicFile without_data_stamp(MusicFile file) {
  std::erase_if(file.connections,
                [](const auto& connection) { return connection.to_port == kDataStampPort; });
  return file;
}

/// The delay in ticks that one of our programs gives its continuous inputs.
std::int64_t signal_delay(const MusicFile& file, const MusicSection& section) {
  const bool ours = find_program(file, section) != nullptr;
  return ours ? std::llround(number_of(file, section, "signal_delay", "1").value_or(0)) : 0;
}

/// By which one of our programs delays its spike inputs: by `spike_delay`, or by what it accepts.
std::int64_t spike_delay(const MusicFile& file, const MusicSection& section,
                         const Latencies& latencies) {
  const auto latency = latencies.by_label.find(section.label);
  const std::int64_t accepted =
      latency == latencies.by_label.end() ? 0 : latency->second / tick_of(file, section);
  const bool ours = find_program(file, section) != nullptr;
  const double written = number_of(file, section, "spike_delay", "1").value_or(0);
  return std::max(accepted, std::int64_t{ours ? std::llround(written) : 0});
}

/// Beside a path of n connections MUSIC serves data_stamp in batches: the ticks of n + 1 come in
/// one burst, and none between the bursts. That is no silence: a watchdog of three ticks, the
/// command adapter's own choice, would stop the robot in every pause.
void add_watchdog(MusicFile& file, const std::string& label, std::size_t connections) {
  constexpr double kOwnChoice = 0.1;
  const MusicSection& section = file.section(label);
  const double factor = number_of(file, section, "rtf", "1").value_or(1);
  const auto ticks = static_cast<double>(connections + 1 + 2);
  const double watchdog = ticks * to_seconds(tick_of(file, section)) / factor;
  if (watchdog > kOwnChoice && std::isfinite(watchdog)) {
    add_key(file, file.section(label), "watchdog", fmt::format("{:.6g}", watchdog));
  }
}

void add_pipeline_ticks(MusicFile& file, const Latencies& latencies) {
  const MusicFile data = without_data_stamp(file);
  for (const std::string& label : age_measuring(file)) {
    const MusicSection* source = first_source_of(data, label);
    if (source == nullptr || !has_data_stamp(file, label)) {
      continue;
    }
    const auto path = data_path(data, source->label, label, continuity(data));
    if (!path) {
      continue;
    }
    std::int64_t ticks = std::max(0, path->continuous_hops - 1);
    for (const std::size_t i : path->connections) {
      const MusicConnection& hop = data.connections[i];
      const MusicSection& to = data.section(hop.to_app);
      ticks += is_continuous(data, hop) ? signal_delay(data, to) : spike_delay(data, to, latencies);
    }
    add_key(file, file.section(label), "pipeline_ticks", fmt::format("{}", ticks));
    add_watchdog(file, label, path->connections.size());
  }
}

/// Ours that wait unless told otherwise, in the order of the file.
std::vector<std::string> sources(const MusicFile& file) {
  std::vector<std::string> labels;
  for (const MusicSection& section : file.sections) {
    const Program* program = find_program(file, section);
    if (program != nullptr && program->source) {
      labels.push_back(section.label);
    }
  }
  return labels;
}

std::vector<std::string> furthest_upstream_first(const MusicFile& file) {
  std::vector<std::string> labels = downstream_first(file);
  std::erase_if(labels,
                [&file](const auto& label) { return find_program(file, label) == nullptr; });
  std::reverse(labels.begin(), labels.end());
  return labels;
}

/// Labels of sections that are connected, directly or through others.
using Part = std::set<std::string>;

std::vector<Part> parts_of(const MusicFile& file) {
  std::vector<Part> parts;
  for (const std::string& label : file.labels()) {
    parts.push_back({label});
  }
  const auto part_with = [&parts](const std::string& label) {
    return std::ranges::find_if(parts, [&](const Part& part) { return part.contains(label); });
  };
  for (const MusicConnection& connection : file.connections) {
    const auto from = part_with(connection.from_app);
    const auto to = part_with(connection.to_app);
    if (from != to) {
      to->merge(*from);
      parts.erase(from);
    }
  }
  return parts;
}

void choose_clock_master(MusicFile& file, const Part& part) {
  const auto written = [&file](const std::string& label) {
    return file.find_key(file.section(label), "clock_master");
  };
  const auto within = [&part](std::vector<std::string> labels) {
    std::erase_if(labels, [&part](const std::string& label) { return !part.contains(label); });
    return labels;
  };
  bool chosen = false;
  for (const std::string& label : part) {
    const MusicKey* key = find_program(file, label) == nullptr ? nullptr : written(label);
    chosen = chosen || (key != nullptr && key->value == "true");
  }
  const auto candidates = within(sources(file));
  for (const std::string& label :
       candidates.empty() ? within(furthest_upstream_first(file)) : candidates) {
    if (written(label) == nullptr && (!chosen || !candidates.empty())) {
      set_key(file.section(label).keys, "clock_master", chosen ? "false" : "true");
      chosen = true;
    }
  }
}

void set_stamp_guards(MusicFile& file) {
  for (MusicSection& section : file.sections) {
    const Program* program = find_program(file, section);
    if (program == nullptr || (program->output != PortKind::spikes && !program->any_class)) {
      continue;
    }
    const auto needs_guard = [&](const MusicConnection& connection) {
      const Program* receiver = find_program(file, connection.to_app);
      return connection.from_app == section.label &&
             (receiver == nullptr || receiver->rounds_times);
    };
    if (std::ranges::none_of(file.connections, needs_guard)) {
      add_key(file, section, "stamp_guard", "false");
    }
  }
}

void set_latencies(MusicFile& file, const Latencies& latencies) {
  for (const auto& [label, latency] : latencies.by_label) {
    add_key(file, file.section(label), "accept_latency", seconds_text(latency));
  }
}

/// Ours help themselves (Process).
void warn_of_eleventh_programs(EffectiveFile& effective) {
  constexpr std::size_t kMost = 10;
  for (std::size_t i = kMost; i < effective.file.sections.size(); ++i) {
    const MusicSection& section = effective.file.sections[i];
    if (find_program(effective.file, section) == nullptr) {
      effective.warnings.push_back(fmt::format(
          "'{}' is program {} of the job, and MUSIC 1.1.16, which Debian has, crashes in "
          "programs after the tenth; run fewer, or use MUSIC 1.1.17",
          section.label, i + 1));
    }
  }
}

}  // namespace

std::optional<double> number_of(const MusicFile& file, const MusicSection& section,
                                const char* name, const char* unit) {
  const MusicKey* key = file.find_key(section, name);
  try {
    return key == nullptr ? std::nullopt : std::optional(parse_quantity(key->value, unit));
  } catch (const ConfigurationError&) {
    return std::nullopt;
  }
}

TimeNs tick_of(const MusicFile& file, const MusicSection& section) {
  const auto tick_s = number_of(file, section, "music_timestep", "s");
  try {
    return tick_s ? tick_from_seconds(*tick_s) : kDefaultTick;
  } catch (const ConfigurationError&) {
    return kDefaultTick;
  }
}

std::optional<TimeNs> stop_time(const MusicFile& file, const MusicSection& section) {
  const auto time_s = number_of(file, section, "stoptime", "s");
  try {
    return time_s ? std::optional(from_seconds(*time_s)) : std::nullopt;
  } catch (const ConfigurationError&) {
    return std::nullopt;
  }
}

std::optional<double> total_time(const MusicFile& file) {
  std::optional<double> smallest;
  for (const MusicSection& section : file.sections) {
    if (const auto time = stop_time(file, section)) {
      smallest = std::min(smallest.value_or(to_seconds(*time)), to_seconds(*time));
    }
  }
  return smallest;
}

std::vector<const MusicSection*> in_written_order(const MusicFile& file) {
  std::vector<const MusicSection*> sections;
  sections.reserve(file.sections.size());
  for (const MusicSection& section : file.sections) {
    sections.push_back(&section);
  }
  std::ranges::stable_sort(sections, {},
                           [](const MusicSection* section) { return section->where.line; });
  return sections;
}

EffectiveFile make_effective(MusicFile file, const RunOptions& options) {
  apply_options(file, options);
  set_node_names(file);
  set_stoptimes(file);
  if (options.data_stamp) {
    add_data_stamp_connections(file);
  }
  for (const Part& part : parts_of(file)) {  // MUSIC synchronises connected programs only
    choose_clock_master(file, part);
  }
  set_stamp_guards(file);
  const Latencies latencies = choose_latencies(file);
  set_latencies(file, latencies);
  add_pipeline_ticks(file, latencies);
  EffectiveFile result{order_downstream_first(std::move(file)), latencies.warnings};
  warn_of_eleventh_programs(result);
  return result;
}

}  // namespace spikeloop::launch
