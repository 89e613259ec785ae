#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "faults.hpp"
#include "spikeloop/core/graph_plan.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"

namespace spikeloop::experiment {
namespace {

constexpr std::uint32_t kMostTicks = 1'000'000;

[[noreturn]] void refuse_delay(const WrittenValue& written, const std::string& reason) {
  throw ConfigurationError(written.where, fmt::format("delay '{}' {}", written.text, reason));
}

/// "2 ticks", "1 tick".
std::optional<double> whole_ticks(const std::string& text) {
  const auto blank = text.find(' ');
  const std::string unit = blank == std::string::npos ? "" : text.substr(blank + 1);
  if (unit != "tick" && unit != "ticks") {
    return std::nullopt;
  }
  std::uint32_t count = 0;
  const char* const end = text.data() + blank;
  const auto parsed = std::from_chars(text.data(), end, count);
  return parsed.ec == std::errc() && parsed.ptr == end ? count : std::nan("");
}

std::uint32_t delay_ticks(const WrittenValue& written, TimeNs tick) {
  std::optional<double> ticks = whole_ticks(written.text);
  if (!ticks) {
    try {
      ticks = parse_quantity(written.text, "s") / to_seconds(tick);
    } catch (const ConfigurationError& error) {
      refuse_delay(written,
                   fmt::format("is no delay: {}; write for example 5 ms or 2 ticks", error.what()));
    }
    if (written.text.find_first_not_of("0123456789.+-eE") == std::string::npos) {
      refuse_delay(written, fmt::format("has no unit; write {0} ms or {0} ticks", written.text));
    }
  }
  const double rounded = std::round(*ticks);
  if (!(rounded >= 0 && rounded <= kMostTicks) || std::fabs(*ticks - rounded) > 1e-6) {
    refuse_delay(written, fmt::format("is not a whole number of ticks from 0 to {}; write a "
                                      "multiple of the tick, {}",
                                      kMostTicks, format_time(tick)));
  }
  return static_cast<std::uint32_t>(rounded);
}

/// Ends of connections, with nodes alone: what they are called is all that counts here.
std::string node_of(const std::string& end) {
  return end.substr(0, end.find('.'));
}

void check_all_connected(const ExperimentFile& file, const Experiment& experiment, Faults& faults) {
  std::set<std::string> reached;
  for (const ExperimentConnection& connection : file.connections) {
    reached.insert(node_of(connection.from));
    reached.insert(node_of(connection.to));
  }
  for (const Part& part : experiment.parts) {
    if (!reached.contains(part.name)) {
      faults.add(part.where, fmt::format("node '{0}' is not connected; write it into "
                                         "'connections', or leave it out",
                                         part.name));
    }
  }
}

class IdleSource : public Source {
 public:
  explicit IdleSource(std::vector<EndpointPort> ports) : ports_(std::move(ports)) {}
  std::vector<EndpointPort> ports() const override { return ports_; }
  void receive(const Step&) override {}

 private:
  std::vector<EndpointPort> ports_;
};

class IdleSink : public Sink {
 public:
  explicit IdleSink(std::vector<EndpointPort> ports) : ports_(std::move(ports)) {}
  std::vector<EndpointPort> ports() const override { return ports_; }
  void send(const Step&) override {}

 private:
  std::vector<EndpointPort> ports_;
};

GraphDescription as_nodes(const ExperimentFile& file, const Experiment& experiment) {
  GraphDescription description;
  description.tick = experiment.tick;
  description.seed = experiment.seed;
  for (const Part& part : experiment.parts) {
    description.nodes.push_back({part.name, part.node_class, part.parameters, part.where});
  }
  for (const ExperimentConnection& connection : file.connections) {
    const bool delayed = !connection.delay.text.empty();
    description.connections.push_back({connection.from, connection.to, connection.width,
                                       delayed ? delay_ticks(connection.delay, experiment.tick) : 0,
                                       connection.where});
  }
  return description;
}

void take_links(const GraphPlan& plan, const ExperimentFile& file, const GraphDescription& graph,
                Experiment& experiment) {
  for (std::size_t i = 0; i < plan.connections.size(); ++i) {
    const PlannedConnection& planned = plan.connections[i];
    Link link{plan.text(planned.from),       plan.text(planned.to), plan.port(planned.from).kind,
              plan.port(planned.from).width, std::nullopt,          planned.where};
    if (!file.connections[i].delay.text.empty()) {
      link.delay_ticks = graph.connections[i].delay_ticks;
    }
    experiment.links.push_back(link);
  }
  for (const PlannedElement& element : plan.elements) {
    for (const PlannedPort& port : element.ports) {
      if (port.direction == Direction::output) {
        experiment.outputs.push_back({element.name, port.name, port.kind, port.width});
      }
    }
  }
}

/// What only widths decide.
void check_part(const Part& part, const Experiment& experiment) {
  if (part.kind == kRosSensor) {
    messages::SensorConversion(messages::Catalog::builtin(), part.parameters.text("message"),
                               sensor_fields(part.parameters), experiment.width(part.name, "out"),
                               true);
  } else if (part.kind == kRosCommand) {
    check_channels(part.mapping, experiment.width(part.name, "in"));
  } else if (part.role == Role::source) {
    playback(part, experiment.width(part.name, "out"));
  }
}

/// Every node once, with nothing at the rim.
void try_nodes(const Experiment& experiment) {
  GraphDescription description;
  description.tick = experiment.tick;
  description.seed = experiment.seed;
  std::vector<std::unique_ptr<IdleSource>> sources;
  std::vector<std::unique_ptr<IdleSink>> sinks;
  for (const Part& part : experiment.parts) {
    if (part.role == Role::node) {
      description.nodes.push_back({part.name, part.node_class, part.parameters, part.where});
      continue;
    }
    const PortDescription& port = part.node_class->description.ports.front();
    const std::vector<EndpointPort> ports{
        {port.name, port.kind, experiment.width(part.name, port.name)}};
    if (part.role == Role::source) {
      sources.push_back(std::make_unique<IdleSource>(ports));
      description.sources.push_back({part.name, sources.back().get()});
    } else {
      sinks.push_back(std::make_unique<IdleSink>(ports));
      description.sinks.push_back({part.name, sinks.back().get()});
    }
  }
  for (const Link& link : experiment.links) {
    description.connections.push_back(
        {link.from, link.to, link.width, link.delay_ticks.value_or(0), link.where});
  }
  const Graph graph(description);
}

}  // namespace

void resolve_links(const ExperimentFile& file, Experiment& experiment, Faults& faults) {
  check_all_connected(file, experiment, faults);
  const bool planned = faults.none() && faults.attempt(file.where_connections, [&] {
    const GraphDescription graph = as_nodes(file, experiment);
    take_links(plan(graph), file, graph, experiment);
  });
  if (!planned) {
    return;
  }
  for (const Part& part : experiment.parts) {
    faults.attempt(part.where, [&] { check_part(part, experiment); });
  }
  if (faults.none()) {
    faults.attempt(file.where_nodes, [&] { try_nodes(experiment); });
  }
}

}  // namespace spikeloop::experiment
