#include "music_import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "node_import.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/core/reason.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDataStamp = "data_stamp";

/// Letters, digits and '_'.
std::string name_of_node(const std::string& label) {
  std::string name = label;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

class Importer {
 public:
  Importer(const MusicFile& file, const ImportOptions& options)
      : file_(file), options_(options), nodes_(file, options, types_, result_) {
    types_.load_plugin_path(plugin_path());
  }

  Imported import() {
    check_structure(file_);
    // The launcher knows how long data take in cycles.
    effective_ = launch::make_effective(file_, {}).file;
    for (const MusicSection& section : file_.sections) {
      import_section(section);
    }
    write_head();
    write_nodes();
    write_connections();
    return std::move(result_);
  }

 private:
  void problem(const Location& where, std::string text) {
    result_.errors.push_back(error_at(where, text));
  }
  void note(const Location& where, std::string text) {
    result_.notes.push_back(warning_at(where, text));
  }

  void import_section(const MusicSection& section) {
    ImportedNode node;
    try {
      node = nodes_.import(section);
    } catch (const Error& error) {
      result_.errors.push_back(diagnostic_of(
          ConfigurationError(error.located() ? error.where() : section.where, reason_of(error))));
      node.left_out = true;
    }
    node.name = name_of_node(section.label);
    if (node.name != section.label) {
      note(section.where,
           fmt::format(
               "'{}' is not a valid node name, it is called '{}': random numbers depend on the "
               "name",
               section.label, node.name));
    }
    imported_[section.label] = order_.size();
    order_.push_back(std::move(node));
  }

  /// What all sections say alike; one that says something else is a problem.
  std::string common(const char* name, const std::string& otherwise) {
    std::optional<std::string> value;
    for (const MusicSection& section : file_.sections) {
      const MusicKey* key = file_.find_key(section, name);
      const std::string own = key == nullptr ? otherwise : key->value;
      if (value && own != *value && launch::find_program(file_, section) != nullptr) {
        problem(key == nullptr ? section.where : key->where,
                fmt::format("section '{}' has {}={}, another one {}: an experiment has one; write "
                            "the same in all",
                            section.label, name, own, *value));
      }
      value = value ? value : own;
    }
    return value.value_or(otherwise);
  }

  double number(const char* name, const std::string& text, const char* unit) {
    const MusicKey* key = find_key(file_.globals, name);
    return located_at(key == nullptr ? Location{file_.path, 0, 0} : key->where,
                      [&] { return parse_quantity(text, unit); });
  }

  bool any(auto&& fits) { return std::ranges::any_of(file_.sections, fits); }

  void write_head() {
    std::string name = name_of_node(fs::path(file_.path).stem().string());
    std::string& text = result_.text;
    text = fmt::format(
        "# Imported from {} by  spikeloop import.\n#\n"
        "# The delays are those of a MUSIC job: a tick a continuous connection, none for spikes.\n"
        "experiment: {}\n",
        fs::path(file_.path).filename().string(), yaml_text(name));
    write_times();
    text += fmt::format("seed: {}\n", common("seed", "1"));
    const bool unpaced = common("sync", "realtime") == "unpaced";
    text += fmt::format("sync: {}\n", unpaced ? "unpaced" : "realtime");
    // Only the clock master heeds it; the launcher makes the first source do so.
    if (const MusicKey* rtf = key_of_clock_master("rtf"); rtf != nullptr && !unpaced) {
      text += fmt::format("real_time_factor: {}\n", rtf->value);
    }
    if (const std::string policy = common(kOnWriteFailureKey, ""); !policy.empty()) {
      text += fmt::format("{}: {}\n", kOnWriteFailureKey, policy);
    }
    if (options_.robot) {
      text += "robot: {simulator: mujoco, world: arena.xml}\n";
    } else if (const int version = common_ros(); version != 0) {
      text += fmt::format("ros: {}\n", version);
    }
    write_plugins();
  }

  /// Of all sections that speak ROS; another one's is a problem.
  int common_ros() {
    int version = 0;
    for (const MusicSection& section : file_.sections) {
      const int own = launch::ros_version(file_, section);
      if (own != 0 && version != 0 && own != version) {
        const MusicKey* key = file_.find_key(section, "ros");
        problem(key == nullptr ? section.where : key->where,
                fmt::format("section '{}' speaks ROS {}, another one ROS {}: an experiment has one "
                            "version; write  ros={}  in all",
                            section.label, own, version, version));
      }
      version = version == 0 ? own : version;
    }
    return version;
  }

  const MusicKey* key_of_clock_master(const char* name) {
    for (const MusicSection& section : effective_.sections) {
      const MusicKey* master = effective_.find_key(section, "clock_master");
      if (master != nullptr && master->value == "true") {
        return effective_.find_key(section, name);
      }
    }
    return find_key(file_.globals, name);
  }

  void write_times() {
    const std::string stop = stoptime();
    const TimeNs tick =
        from_seconds(number("music_timestep", common("music_timestep", "0.001"), "s"));
    tick_ = tick;
    if (!stop.empty()) {
      result_.text +=
          fmt::format("duration: {}\n", format_time(from_seconds(number("stoptime", stop, "s"))));
    }
    result_.text += fmt::format("tick: {}\n", format_time(tick));
  }

  /// The launcher has written what a section of dialect ma takes for itself; empty: until stopped.
  std::string stoptime() {
    std::string earliest;
    for (const MusicSection& section : effective_.sections) {
      const MusicKey* key = effective_.find_key(section, "stoptime");
      if (key != nullptr && (earliest.empty() || number("stoptime", key->value, "s") <
                                                     number("stoptime", earliest, "s"))) {
        earliest = key->value;
      }
    }
    return earliest;
  }

  void write_plugins() {
    std::set<std::string> plugins;
    for (const ImportedNode& node : order_) {
      if (!node.plugin.empty()) {
        plugins.insert(node.plugin);
      }
    }
    if (!plugins.empty()) {
      result_.text += "plugins:\n";
      for (const std::string& plugin : plugins) {
        result_.text += fmt::format("  - {}\n", plugin);
      }
    }
  }

  void write_nodes() {
    result_.text += "\nnodes:\n";
    for (const ImportedNode& node : order_) {
      if (node.left_out) {
        result_.text += fmt::format(
            "  # {}: what an experiment cannot do; see what  spikeloop import  said\n", node.name);
        continue;
      }
      result_.text += fmt::format("  {}:\n", node.name);
      for (const auto& [key, value] : node.keys) {
        result_.text +=
            fmt::format("    {}:{}{}\n", key, value.starts_with('\n') ? "" : " ", value);
      }
    }
  }

  const ImportedNode& node(const std::string& label) const { return order_[imported_.at(label)]; }

  /// "encoder", or "encoder.port" where a node has several ports of this direction.
  std::string end(const std::string& label, const std::string& port, Direction direction) const {
    const ImportedNode& of = node(label);
    const auto count =
        of.description == nullptr
            ? 0
            : std::ranges::count(of.description->ports, direction, &PortDescription::direction);
    return count == 1 && of.description != nullptr ? of.name : fmt::format("{}.{}", of.name, port);
  }

  /// As the classes say, which the launcher does not know of plug-ins.
  bool is_continuous(const MusicConnection& connection) const {
    for (const auto& [label, port] : {std::pair(connection.from_app, connection.from_port),
                                      std::pair(connection.to_app, connection.to_port)}) {
      if (const NodeDescription* description = node(label).description) {
        const auto found = std::ranges::find(description->ports, port, &PortDescription::name);
        if (found != description->ports.end()) {
          return found->kind == PortKind::signal;
        }
      }
    }
    return launch::is_continuous(file_, connection);
  }

  /// In the job, as the receiver's keys say and what the launcher adds to them.
  std::int64_t delay_ticks(const MusicConnection& connection) {
    const MusicSection& receiver = effective_.section(connection.to_app);
    const auto ticks = [&](const char* name, const char* unit, double of) {
      const MusicKey* key = effective_.find_key(receiver, name);
      return key == nullptr
                 ? std::int64_t{0}
                 : std::llround(
                       located_at(key->where, [&] { return parse_quantity(key->value, unit); }) /
                       of);
    };
    if (is_continuous(connection)) {
      return 1 + ticks("signal_delay", "1", 1);
    }
    const std::int64_t written = ticks("spike_delay", "1", 1);
    const std::int64_t accepted = ticks("accept_latency", "s", to_seconds(tick_));
    if (accepted > written) {
      note(connection.where,
           fmt::format("the spikes of {} come {} tick{} late in the job, and have their own times: "
                       "here they are delayed by as much, which gives other spikes",
                       describe(connection), accepted, accepted == 1 ? "" : "s"));
    }
    return std::max(written, accepted);
  }

  void write_connections() {
    result_.text += "\nconnections:\n";
    for (const MusicConnection& connection : file_.connections) {
      if (connection.to_port == kDataStamp && connection.from_port == kDataStamp) {
        continue;  // an experiment knows how old its data are
      }
      const bool left_out = node(connection.from_app).left_out || node(connection.to_app).left_out;
      const std::int64_t ticks = delay_ticks(connection);
      const std::string width =
          connection.width ? fmt::format("{}, ", *connection.width) : std::string();
      result_.text += fmt::format("  {}- {} -> {} [{}delay {} tick{}]\n", left_out ? "# " : "",
                                  end(connection.from_app, connection.from_port, Direction::output),
                                  end(connection.to_app, connection.to_port, Direction::input),
                                  width, ticks, ticks == 1 ? "" : "s");
    }
  }

  const MusicFile& file_;
  const ImportOptions& options_;
  MusicFile effective_;
  Imported result_;
  experiment::NodeTypes types_;
  NodeImporter nodes_;
  std::vector<ImportedNode> order_;
  std::map<std::string, std::size_t> imported_;
  TimeNs tick_ = 0;
};

}  // namespace

Imported import_music(const MusicFile& file, const ImportOptions& options) {
  return Importer(file, options).import();
}

}  // namespace spikeloop::app
