#include "run_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "spikeloop/core/log.hpp"
#include "spikeloop/core/units.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::fused {
namespace {

using experiment::Experiment;
using nlohmann::json;

constexpr std::uint64_t kTicksPerOverrun = 100;  // more overruns are worth a warning

/// The double nearest to the time, which is printed with the fewest digits.
double exact_seconds(TimeNs time) {
  return static_cast<double>(time) / 1e9;
}

json counters_of(const Graph& graph) {
  json counters = json::object();
  for (const Counter& counter : graph.counters()) {
    if (!is_recording(counter.name)) {  // those are summed up elsewhere
      counters[name_in_file(counter.name)] = counter.value;
    }
  }
  for (const ConnectionReport& connection : graph.connections()) {
    if (connection.spikes > 0 && !is_recording(connection.to) && !is_sent(connection.to)) {
      const std::string name = name_in_file(connection.from) + "->" + name_in_file(connection.to);
      counters[name + ".spikes"] = connection.spikes;
      counters[name + ".late"] = connection.late;
    }
  }
  return counters;
}

/// The sum of one counter over the nodes that `picks` picks; none when it picks none.
template <typename Picks>
void add_sum(const Experiment& experiment, const char* counter, const char* key, Picks&& picks,
             json& summary) {
  for (const auto& node : experiment.nodes) {
    const std::string name = fmt::format("{}.{}", node.name, counter);
    if (picks(node) && summary["counters"].contains(name)) {
      summary[key] = summary.value(key, std::uint64_t{0}) +
                     summary["counters"][name].template get<std::uint64_t>();
    }
  }
}

/// The first process that takes from a simulator counts its spikes.
bool counts(const Experiment& experiment, const std::string& process, const std::string& from) {
  const auto first = std::ranges::find_if(experiment.connections, [&](const auto& connection) {
    return connection.from == from && !experiment::is_simulator_end(experiment, connection.to);
  });
  return experiment::is_simulator_end(experiment, from) && first != experiment.connections.end() &&
         process_of(experiment, experiment::node_of(first->to)) == process;
}

/// Counts each spike once, even if it reached several nodes of this process.
void add_spikes_of_simulators(const Experiment& experiment, const std::string& process,
                              const Graph& graph, json& summary) {
  std::map<std::string, std::uint64_t> spikes;
  for (const ConnectionReport& connection : graph.connections()) {
    const std::string from = name_in_file(connection.from);
    if (counts(experiment, process, from)) {
      spikes[from] = std::max(spikes[from], connection.sent);
    }
  }
  for (const auto& [from, count] : spikes) {
    summary["spikes"] = summary.value("spikes", std::uint64_t{0}) + count;
  }
}

const char* how_to_look(experiment::Ros ros) {
  switch (ros) {
    case experiment::Ros::ros1:
      return "; 'rostopic list' shows what there is";
    case experiment::Ros::ros2:
      return "; 'ros2 topic list' shows what there is";
    case experiment::Ros::none:
      break;
  }
  return "";
}

}  // namespace

json summary_of(const Experiment& experiment, const Surroundings& surroundings, Assembly& assembly,
                const Progress& progress) {
  const Graph& graph = assembly.graph();
  json summary{{"experiment", experiment.name},
               {"layout", name_of(experiment.layout)},
               {"sync", experiment::name_of(experiment.sync)},
               {"seed", experiment.seed},
               {"tick_ns", experiment.tick},
               {"version", SPIKELOOP_VERSION},
               {"simulated_s", exact_seconds(progress.simulated)},
               {"wall_s", to_seconds(progress.wall)},
               {"overruns", progress.overruns},
               {"counters", counters_of(graph)}};
  summary["real_time_factor"] =
      progress.wall > 0 ? to_seconds(progress.simulated) / to_seconds(progress.wall) : 0.0;
  summary.update(assembly.summary());
  summary.update(surroundings.transport.summary());
  const auto is_network = [](const auto& node) { return node.kind == experiment::kNetwork; };
  const auto is_laser = [](const auto& node) {
    return node.kind == experiment::kRosSensor &&
           node.parameters.text("message") == "sensor_msgs/LaserScan";
  };
  add_sum(experiment, "spikes", "spikes", is_network, summary);
  add_sum(experiment, "messages", "scans", is_laser, summary);
  add_spikes_of_simulators(experiment, surroundings.process, graph, summary);
  return summary;
}

void warn_of_silence(const Experiment& experiment, const Transport& transport,
                     const json& summary) {
  for (const auto& node : experiment.nodes) {
    const auto count = [&](const char* name, std::uint64_t missing) {
      return summary.contains("counters") ? summary["counters"].value(node.name + name, missing)
                                          : missing;
    };
    // Another type on the topic has its own message.
    if (experiment::takes_messages(node.kind) && count(".messages", 1) == 0 &&
        count(".wrong_type", 0) == 0) {
      log::warning("no message arrived on topic '{}'{}",
                   transport.whole_topic(node.parameters.text("topic")),
                   how_to_look(experiment.ros));
    }
  }
}

void warn_of_overruns(const Experiment& experiment, const Progress& progress, TimeNs computing) {
  const auto ticks = static_cast<std::uint64_t>(progress.simulated / experiment.tick);
  if (progress.overruns <= ticks / kTicksPerOverrun || computing <= 0) {
    return;
  }
  const double speed = to_seconds(progress.simulated) / to_seconds(computing);
  const bool by_clock = experiment.sync == Sync::sim_time;
  if (!by_clock && speed > experiment.real_time_factor) {
    return;  // single ticks were slow, or other programs used the processor
  }
  const std::string shown = format_rounded(speed, 2);
  const auto remedy =
      by_clock ? fmt::format("let the simulator run at less than {} times real time", shown)
               : fmt::format("a real_time_factor below {} can be kept", shown);
  log::warning("{} of {} ticks began more than a tick late. Computing 1 s takes {} s here; {}",
               progress.overruns, ticks, format_rounded(1 / speed, 2), remedy);
}

}  // namespace spikeloop::fused
