// The processes of a layout as sections. docs/architecture.md has the latencies.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "job_writer.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::experiment {
namespace {

constexpr const char* kProgram = "spikeloop-fused";
constexpr const char* kRecordKey = "record";  // of every program

class ProcessWriter : JobWriter {
 public:
  ProcessWriter(const Experiment& experiment, const std::string& folder)
      : JobWriter(experiment, folder) {}

  MusicJob write(const std::map<std::string, std::string>& keys) {
    write_globals();
    for (const Process& process : experiment_.layout.processes) {
      begin_section(process.name, {experiment_.path, 0, 0});
      write_process(process);
      for (const auto& [name, value] : keys) {
        add(name.c_str(), value);
      }
    }
    for (const Node& node : experiment_.nodes) {
      if (is_simulator(node)) {
        begin_section(node.name, node.where);
        write_simulator(node);
        if (const auto record = keys.find(kRecordKey); record != keys.end()) {
          add(kRecordKey, node.record ? record->second : "false");
        }
      }
    }
    for (const Connection& connection : experiment_.connections) {
      check_simulator_input(connection);
    }
    for (const Connection& edge : edges(experiment_)) {
      write_edge(edge);
    }
    if (needs_music(experiment_)) {
      check_joined();
      check_receivers();
    }
    return std::move(job_);
  }

 private:
  /// A part of a tick: what the acceptable latencies of a cycle have to spare, so that they add up
  /// to a tick a process, though spikes are late by whole ticks alone. It serves for cycles of 99
  /// programs.
  TimeNs spare() const { return std::max<TimeNs>(1, experiment_.tick / 100); }

  void write_process(const Process& process) {
    add("np", "1");
    add("binary", kProgram);
    add_directory({});
    add("experiment", std::filesystem::absolute(experiment_.path).string());
    add("settings", to_text(experiment_.settings));
    add("clock_master", waits_for_clock(experiment_, process.name) ? "true" : "false");
    add("ros", name_of(experiment_.ros));
    if (process.in_cycle) {
      add("accept_latency", seconds((process.spike_delay + 1) * experiment_.tick - spare()));
      add("spike_delay", std::to_string(process.spike_delay));
      add("signal_delay", "2");
    }
    add("stamp_guard", rounds_times() ? "true" : "false");
  }

  /// As NEST does: a spike right behind the begin of its tick would be the tick's before.
  bool rounds_times() const {
    return std::ranges::any_of(experiment_.nodes, [](const Node& node) {
      return is_simulator(node) && node.kind == "nest";
    });
  }

  bool takes_signals(const Node& node) const {
    return std::ranges::any_of(experiment_.connections, [&](const Connection& connection) {
      return connection.kind == PortKind::signal && node_of(connection.to) == node.name;
    });
  }

  void write_simulator(const Node& node) {
    add(node, "np", "1");
    add_directory(node.where);
    add_script(node);
    const std::uint32_t spikes = input_delay(node, PortKind::spikes);
    add(node, "accept_latency", seconds((spikes + 1) * experiment_.tick - spare()));
    if (spikes > 0) {
      add(node, "spike_delay", std::to_string(spikes));
    }
    if (takes_signals(node)) {
      add(node, "signal_delay", std::to_string(input_delay(node, PortKind::signal) - 1));
    }
    add(node, "stamp_guard", "false");
  }

  /// Ticks by which all of a simulator's inputs of one kind are late when MUSIC hands them over.
  std::uint32_t input_delay(const Node& simulator, PortKind kind) const {
    const auto connection =
        std::ranges::find_if(experiment_.connections, [&](const Connection& input) {
          return input.kind == kind && node_of(input.to) == simulator.name;
        });
    return connection == experiment_.connections.end() ? 0 : music_delay(experiment_, *connection);
  }

  void write_edge(const Connection& edge) {
    const std::string from = process_of(experiment_, node_of(edge.from));
    const std::string to = process_of(experiment_, node_of(edge.to));
    const bool to_simulator = is_simulator_end(experiment_, edge.to);
    const std::string& end = to_simulator ? edge.to : edge.from;
    // One output that several nodes of a process take from is one connection of MUSIC's; so is an
    // input of a simulator whose senders the sending process combines.
    if (from == to || !taken_.insert({end, to}).second) {
      return;
    }
    const std::string name = process_port(end);
    if (const auto known = ports_.emplace(name, end).first; known->second != end) {
      throw ConfigurationError(
          edge.where, with_code(Code::layout,
                                "'{}' and '{}' would be one port of MUSIC's, {}; give one of the "
                                "nodes a name without '__'",
                                known->second, end, name));
    }
    const std::string from_port =
        is_simulator_end(experiment_, edge.from) ? port_of(edge.from) : name;
    if (edge.kind == PortKind::spikes) {
      ++receivers_[{from, from_port}];
    }
    job_.file.connections.push_back(
        {from,
         from_port,
         to,
         to_simulator ? port_of(edge.to) : name,
         to_simulator ? experiment_.width(node_of(edge.to), port_of(edge.to)) : edge.width,
         {},
         {},
         edge.where});
    joined_.insert({from, to});
  }

  void check_simulator_input(const Connection& connection) const {
    if (!is_simulator_end(experiment_, connection.to)) {
      return;
    }
    check_combination(connection);
    const std::uint32_t delay = connection.delay_ticks.value_or(0);
    const std::uint32_t least = music_delay(experiment_, connection);
    const bool waits = !is_simulator_end(experiment_, connection.from);
    if (waits ? delay >= least : delay == least) {
      return;
    }
    const Connection* first = from_simulator(experiment_, node_of(connection.to), connection.kind);
    throw ConfigurationError(
        connection.where,
        with_code(Code::delay,
                  "the inputs '{}' and '{}' have different delays, and a simulator waits for all "
                  "of its inputs as long as for those from another one; write {}[delay {}]",
                  first->to, connection.to, waits ? "at least " : "", format_ticks(least)));
  }

  /// The graph of the sending process combines what a simulator's input takes.
  void check_combination(const Connection& connection) const {
    const bool from_simulator = is_simulator_end(experiment_, connection.from);
    if (from_simulator && !connection.channels.all()) {
      throw ConfigurationError(
          connection.where,
          with_code(Code::layout,
                    "no graph selects the channels of '{}' before '{}', which is an input of "
                    "another simulator; put another node between them",
                    connection.from, connection.to));
    }
    if (connection.combination == Combination::alone) {
      return;
    }
    const auto first = std::ranges::find(experiment_.connections, connection.to, &Connection::to);
    const std::string process = process_of(experiment_, node_of(first->from));
    const std::string other = process_of(experiment_, node_of(connection.from));
    if (process != other) {
      throw ConfigurationError(
          connection.where,
          with_code(Code::layout,
                    "'{}' and '{}' are in the processes '{}' and '{}', and the senders of one "
                    "input of a simulator must be in one process; put them into one process, or "
                    "put another node before '{}'",
                    first->from, connection.from, process, other, connection.to));
    }
    if (from_simulator) {
      throw ConfigurationError(
          connection.where,
          with_code(Code::layout,
                    "'{}' and '{}' are outputs of a simulator, and no graph combines them before "
                    "'{}', which is an input of another one; put another node between them",
                    first->from, connection.from, connection.to));
    }
  }

  void check_joined() const {
    for (const Process& process : experiment_.layout.processes) {
      if (!joined_.contains(process.name)) {
        refuse_alone(process.name);
      }
    }
  }

  void check_receivers() const {
    for (const auto& [port, receivers] : receivers_) {
      if (crashes_music(receivers)) {
        throw ConfigurationError(
            experiment_.layout.where,
            with_code(Code::layout,
                      "{} processes take the spikes '{}' of process '{}', and {}; put two of them "
                      "into one process",
                      receivers, port.second, port.first, kCrashesMusic));
      }
    }
  }

  [[noreturn]] void refuse_alone(const std::string& process) const {
    if (experiment_.layout.kind != Layout::Kind::fused) {
      throw ConfigurationError(
          experiment_.layout.where,
          with_code(Code::not_connected,
                    "no connection joins process '{}' with another one, and MUSIC would wait for "
                    "ever; connect its nodes, or put them into another process",
                    process));
    }
    throw ConfigurationError(
        experiment_.nodes.front().where,
        with_code(
            Code::not_connected,
            "no connection joins the simulators with the other nodes, which one process has in the "
            "fused layout, and MUSIC would wait forever; connect them, or use --layout separate"));
  }

  std::set<std::pair<std::string, std::string>> taken_;  ///< an end, and the process it goes to
  std::set<std::string> joined_;
  /// How many processes take from a port of spikes.
  std::map<std::pair<std::string, std::string>, std::size_t> receivers_;
  std::map<std::string, std::string> ports_;  ///< their ends by their names
};

}  // namespace

std::string process_port(const std::string& end) {
  return fmt::format("{}__{}", node_of(end), port_of(end));
}

MusicJob process_job(const Experiment& experiment, const std::string& folder,
                     const std::map<std::string, std::string>& keys) {
  return ProcessWriter(experiment, folder).write(keys);
}

}  // namespace spikeloop::experiment
