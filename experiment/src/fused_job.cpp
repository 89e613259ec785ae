// The fused layout with simulators beside it. docs/architecture.md has the latencies.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "job_writer.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::experiment {
namespace {

constexpr const char* kProgram = "spikeloop-fused-music";

bool is_inside(const Experiment& experiment, const std::string& end) {
  return !is_simulator_end(experiment, end);
}

/// Into a simulator from another one: there is no graph in which such a connection could wait.
const Link* from_simulator(const Experiment& experiment, const std::string& part, PortKind kind) {
  const auto found = std::ranges::find_if(experiment.links, [&](const Link& link) {
    return link.kind == kind && node_of(link.to) == part && !is_inside(experiment, link.from);
  });
  return found == experiment.links.end() ? nullptr : &*found;
}

/// Ticks by which all of a simulator's inputs of one kind are late when MUSIC hands them over.
std::uint32_t arrival(const Experiment& experiment, const std::string& part, PortKind kind) {
  const Link* link = from_simulator(experiment, part, kind);
  return link == nullptr ? least_input_delay(kind) : link->delay_ticks.value_or(0);
}

class FusedWriter : JobWriter {
 public:
  FusedWriter(const Experiment& experiment, const std::string& folder)
      : JobWriter(experiment, folder), label_(own_label(experiment)) {}

  MusicJob write(const std::map<std::string, std::string>& keys) {
    write_globals();
    begin_section(label_, {experiment_.path, 0, 0});
    write_own(keys);
    for (const Part& part : experiment_.parts) {
      if (is_simulator(part)) {
        begin_section(part.name, part.where);
        write_simulator(part);
      }
    }
    for (const Link& link : experiment_.links) {
      write_link(link);
    }
    check_joined();
    return std::move(job_);
  }

 private:
  /// A part of a tick: what the acceptable latencies of a cycle have to spare, so that they add up
  /// to a tick a process, though spikes are late by one alone. It serves for cycles of 99 programs.
  TimeNs spare() const { return std::max<TimeNs>(1, experiment_.tick / 100); }

  void write_own(const std::map<std::string, std::string>& keys) {
    add("np", "1");
    add("binary", kProgram);
    add_directory({});
    add("experiment", std::filesystem::absolute(experiment_.path).string());
    add("pace", "true");
    add("ros", name_of(experiment_.ros));
    add("wait_for", std::string(name_of(experiment_.sync)));
    add("accept_latency", seconds(2 * experiment_.tick - spare()));
    add("spike_delay", "1");
    add("signal_delay", "2");
    add("stamp_guard", rounds_times() ? "true" : "false");
    for (const auto& [name, value] : keys) {
      add(name.c_str(), value);
    }
  }

  /// As NEST does: a spike right behind the begin of its tick would be the tick's before.
  bool rounds_times() const {
    return std::ranges::any_of(experiment_.parts, [](const Part& part) {
      return is_simulator(part) && part.kind == "nest";
    });
  }

  bool takes_signals(const Part& part) const {
    return std::ranges::any_of(experiment_.links, [&](const Link& link) {
      return link.kind == PortKind::signal && node_of(link.to) == part.name;
    });
  }

  void write_simulator(const Part& part) {
    add(part, "np", "1");
    add_directory(part.where);
    add_script(part);
    const std::uint32_t spikes = arrival(experiment_, part.name, PortKind::spikes);
    add(part, "accept_latency", seconds((spikes + 1) * experiment_.tick - spare()));
    if (spikes > 0) {
      add(part, "spike_delay", std::to_string(spikes));
    }
    if (takes_signals(part)) {
      add(part, "signal_delay",
          std::to_string(arrival(experiment_, part.name, PortKind::signal) - 1));
    }
    add(part, "stamp_guard", "false");
  }

  void write_link(const Link& link) {
    const bool from_inside = is_inside(experiment_, link.from);
    const bool to_inside = is_inside(experiment_, link.to);
    if (!to_inside) {
      check_arrival(link);
    }
    if (from_inside && to_inside) {
      return;
    }
    // One output that several nodes here take from is one connection of MUSIC's.
    if (to_inside && !taken_.insert(link.from).second) {
      return;
    }
    job_.file.connections.push_back({from_inside ? label_ : node_of(link.from),
                                     from_inside ? fused_port(link.to) : port_of(link.from),
                                     to_inside ? label_ : node_of(link.to),
                                     to_inside ? fused_port(link.from) : port_of(link.to),
                                     link.width,
                                     {},
                                     {},
                                     link.where});
    joined_ = joined_ || from_inside || to_inside;
  }

  void check_arrival(const Link& link) const {
    const std::string part = node_of(link.to);
    const Link* first = from_simulator(experiment_, part, link.kind);
    const std::uint32_t delay = link.delay_ticks.value_or(0);
    const std::uint32_t least = arrival(experiment_, part, link.kind);
    const bool inside = is_inside(experiment_, link.from);
    if (inside ? delay < least : delay != least) {
      throw ConfigurationError(
          link.where,
          fmt::format("the inputs '{}' and '{}' have different delays, and a simulator waits for "
                      "all of its inputs as long as for those from another one; write {}[delay {}]",
                      first->to, link.to, inside ? "at least " : "", format_ticks(least)));
    }
  }

  void check_joined() const {
    if (!joined_) {
      throw ConfigurationError(
          experiment_.parts.front().where,
          "no connection joins the simulators with the other nodes, which one process has in the "
          "fused layout, and MUSIC would wait for ever; connect them, or use --layout separate");
    }
  }

  std::string label_;
  std::set<std::string> taken_;
  bool joined_ = false;
};

}  // namespace

std::string fused_port(const std::string& end) {
  return fmt::format("{}__{}", node_of(end), port_of(end));
}

MusicJob fused_job(const Experiment& experiment, const std::string& folder,
                   const std::map<std::string, std::string>& keys) {
  return FusedWriter(experiment, folder).write(keys);
}

std::uint32_t fused_edge_delay(const Experiment& experiment, const Link& link) {
  const std::uint32_t delay = link.delay_ticks.value_or(0);
  const bool to_inside = is_inside(experiment, link.to);
  if (to_inside) {
    return delay - least_delay(experiment, link);
  }
  return delay - arrival(experiment, node_of(link.to), link.kind);
}

}  // namespace spikeloop::experiment
