#include "job_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "faults.hpp"
#include "spikeloop/core/script_keys.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::experiment {

void JobWriter::write_globals() {
  const auto global = [this](const char* name, const std::string& value) {
    set_key(job_.file.globals, name, value);
  };
  if (experiment_.duration) {
    global("stoptime", seconds(*experiment_.duration));
  }
  global("music_timestep", seconds(experiment_.tick));
  global("seed", std::to_string(experiment_.seed));
  global("strict", "true");
  global("barrier", "false");
  global("rtf", fmt::format("{}", experiment_.real_time_factor));
  global("sync", experiment_.sync == Sync::realtime ? "realtime" : "unpaced");
  if (experiment_.on_write_failure == OnWriteFailure::proceed) {
    global(kOnWriteFailureKey, to_text(experiment_.on_write_failure));
  }
}

void JobWriter::begin_section(const std::string& label, const Location& where) {
  job_.file.sections.push_back({label, {}, where});
}

void JobWriter::add(const char* name, const std::string& value, const Location& where) {
  auto& keys = job_.file.sections.back().keys;
  set_key(keys, name, value);
  std::ranges::find(keys, name, &MusicKey::name)->where = where;  // not always the last one
}

void JobWriter::add(const Node& node, const std::string& name, const std::string& value,
                    const std::string& key) {
  const auto written = node.written.find(key.empty() ? name : key);
  add(name.c_str(), value, written == node.written.end() ? node.where : written->second.where);
}

void JobWriter::add_directory(const Location& where) {
  add("wd", std::filesystem::absolute(directory_of(experiment_.origin)).string(), where);
}

void JobWriter::add_script(const Node& node) {
  add(node, "binary", "spikeloop-script");
  add(node, "experiment_file", std::filesystem::absolute(experiment_.origin).string());
  for (const auto& [name, value] : node.written) {
    add(node, name, value.text);
  }
  add(node, "script", std::filesystem::absolute(node.parameters.text("script")).string());
  add_kinds(node);
}

void JobWriter::add_kinds(const Node& node) {
  std::map<std::string, std::set<std::string>> ports;
  const auto take = [&](const Connection& connection, const std::string& own,
                        const std::string& other, Direction direction) {
    // Between two simulators the kind is a guess.
    if (node_of(own) == node.name && !is_simulator_end(experiment_, other)) {
      ports[script_key(connection.kind, direction)].insert(port_of(own));
    }
  };
  for (const Connection& connection : experiment_.connections) {
    take(connection, connection.to, connection.from, Direction::input);
    take(connection, connection.from, connection.to, Direction::output);
  }
  for (const auto& [key, names] : ports) {
    add(node, key, fmt::format("{}", fmt::join(names, ",")));
  }
}

std::string JobWriter::seconds(TimeNs time) {
  return fmt::format("{}.{:09}", time / kNsPerSecond, time % kNsPerSecond);
}

}  // namespace spikeloop::experiment
