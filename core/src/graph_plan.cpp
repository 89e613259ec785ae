#include "spikeloop/core/graph_plan.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "planned_input.hpp"
#include "spikeloop/core/connection_faults.hpp"

namespace spikeloop {

const PortDescription* find_output(const GraphDescription& description, std::string_view end) {
  for (const auto& entry : description.nodes) {
    for (const PortDescription& port : entry.node_class->description.ports) {
      if (port.direction == Direction::output &&
          end == fmt::format("{}.{}", entry.name, port.name)) {
        return &port;
      }
    }
  }
  return nullptr;
}

std::uint32_t ChannelRange::count(std::uint32_t width) const {
  return end != 0 ? end - begin : width > begin ? width - begin : 0;
}

std::string ChannelRange::text() const {
  if (all()) {
    return "";
  }
  return end == begin + 1 ? fmt::format("[{}]", begin)
         : end == 0       ? fmt::format("[{}:]", begin)
                          : fmt::format("[{}:{}]", begin, end);
}

namespace {

PlannedElement planned_node(const GraphDescription::NodeEntry& entry) {
  PlannedElement element{entry.name, {}, entry.where};
  for (const PortDescription& port : entry.node_class->description.ports) {
    const bool fixed = port.width.kind == WidthRule::Kind::fixed;
    element.ports.push_back(
        {port.name, port.kind, port.direction, port.width, fixed ? port.width.value : 0});
  }
  return element;
}

PlannedElement planned_endpoint(const std::string& name, const std::vector<EndpointPort>& ports,
                                Direction direction) {
  PlannedElement element{name, {}, {}};
  for (const EndpointPort& port : ports) {
    element.ports.push_back({port.name, port.kind, direction, {}, port.width});
  }
  return element;
}

std::vector<PlannedElement> planned_elements(const GraphDescription& description) {
  std::vector<PlannedElement> elements;
  elements.reserve(description.sources.size() + description.nodes.size() +
                   description.sinks.size());
  for (const auto& entry : description.sources) {
    elements.push_back(planned_endpoint(entry.name, entry.source->ports(), Direction::output));
  }
  for (const auto& entry : description.nodes) {
    elements.push_back(planned_node(entry));
  }
  for (const auto& entry : description.sinks) {
    elements.push_back(planned_endpoint(entry.name, entry.sink->ports(), Direction::input));
  }
  std::set<std::string> seen;
  for (const PlannedElement& element : elements) {
    if (!seen.insert(element.name).second) {
      throw ConfigurationError(
          element.where,
          with_code(Code::duplicate_name, "two nodes are named '{}'; give each its own name",
                    element.name));
    }
  }
  return elements;
}

std::size_t find_element(const std::vector<PlannedElement>& elements, const std::string& name,
                         const Location& where) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (elements[i].name == name) {
      return i;
    }
    names.push_back(elements[i].name);
  }
  throw ConfigurationError(where, unknown_node(name, names));
}

PlannedPortAddress find_port(const std::vector<PlannedElement>& elements,
                             const std::string& written, Direction direction,
                             const Location& where) {
  const auto dot = written.find('.');
  const std::size_t index = find_element(elements, written.substr(0, dot), where);
  const PlannedElement& element = elements[index];
  const char* direction_text = direction == Direction::input ? "input" : "output";
  std::vector<std::size_t> candidates;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < element.ports.size(); ++i) {
    if (element.ports[i].direction == direction) {
      candidates.push_back(i);
      names.push_back(element.ports[i].name);
    }
  }
  if (candidates.empty()) {
    throw ConfigurationError(
        where, with_code(Code::unknown_port,
                         "'{}' has no {} port; turn the connection round or leave it out",
                         element.name, direction_text));
  }
  if (dot == std::string::npos) {
    const auto usual =
        std::ranges::find(names, usual_port(direction));  // stays meant when others are added
    if (usual != names.end()) {
      return {index, candidates[static_cast<std::size_t>(usual - names.begin())]};
    }
    if (candidates.size() > 1) {
      throw ConfigurationError(
          where, with_code(Code::unknown_port, "'{}' has several {} ports; write one of: {}.{}",
                           written, direction_text, element.name,
                           fmt::join(names, fmt::format(", {}.", element.name))));
    }
    return {index, candidates.front()};
  }
  const std::string port = written.substr(dot + 1);
  for (const std::size_t i : candidates) {
    if (element.ports[i].name == port) {
      return {index, i};
    }
  }
  throw ConfigurationError(where, unknown_port(element.name, direction, port, names));
}

bool settle_same_as(PlannedElement& element) {
  bool changed = false;
  for (PlannedPort& port : element.ports) {
    if (port.rule.kind == WidthRule::Kind::same_as) {
      PlannedPort& other = element.ports[port.rule.value];
      changed |= settle(port.width, other.width);
      changed |= settle(other.width, port.width);
    }
  }
  return changed;
}

std::vector<PlannedInput> planned_inputs(GraphPlan& plan, const GraphDescription& description) {
  std::vector<PlannedInput> inputs;
  for (std::size_t i = 0; i < plan.connections.size(); i = inputs.back().end()) {
    inputs.emplace_back(plan, description, i);
  }
  return inputs;
}

void settle_widths(GraphPlan& plan, std::vector<PlannedInput>& inputs) {
  for (bool changed = true; changed;) {
    changed = false;
    for (PlannedInput& input : inputs) {
      changed |= input.settle_input();
    }
    for (PlannedElement& element : plan.elements) {
      changed |= settle_same_as(element);
    }
    for (auto input = inputs.begin(); !changed && input != inputs.end(); ++input) {
      changed = input->settle_senders();
    }
  }
}

void check_node_widths(const GraphPlan& plan, const ErrorHandler& report) {
  for (const PlannedElement& element : plan.elements) {
    for (const PlannedPort& port : element.ports) {
      const bool fixed = port.rule.kind == WidthRule::Kind::fixed;
      const bool same = port.rule.kind == WidthRule::Kind::same_as;
      const std::uint32_t wanted =
          fixed ? port.rule.value : (same ? element.ports[port.rule.value].width : port.width);
      if (port.width != wanted) {
        report(ConfigurationError(
            element.where,
            with_code(Code::widths_differ, "port '{}.{}' has {} channels but must have {}{}",
                      element.name, port.name, port.width, wanted,
                      same ? fmt::format(", as many as '{}.{}'", element.name,
                                         element.ports[port.rule.value].name)
                           : "")));
      }
    }
  }
}

/// Inputs with their senders.
using Inputs = std::map<std::pair<std::size_t, std::size_t>, std::string>;

void check_inputs(const GraphPlan& plan, const Inputs& reached, const ErrorHandler& report) {
  for (std::size_t e = 0; e < plan.elements.size(); ++e) {
    for (std::size_t p = 0; p < plan.elements[e].ports.size(); ++p) {
      const bool input = plan.elements[e].ports[p].direction == Direction::input;
      if (input && reached.count({e, p}) == 0) {
        report(ConfigurationError(plan.elements[e].where, not_connected(plan.text({e, p}))));
      }
    }
  }
}

class Connector {
 public:
  Connector(GraphPlan& plan, const ErrorHandler& report) : plan_(plan), report_(report) {}

  void connect(const ConnectionDescription& written) {
    const auto from = find(written.from, Direction::output,
                           written.where_from.text().empty() ? written.where : written.where_from);
    const auto to = find(written.to, Direction::input, written.where);
    const std::string sender = from ? plan_.text(*from) : written.from;
    if (to) {
      const auto [first, is_new] = reached_.try_emplace({to->element, to->port}, sender);
      if (!is_new && written.combination == Combination::alone) {
        report_(ConfigurationError(written.where,
                                   two_connections(plan_.text(*to), first->second, sender)));
      }
    }
    if (!from || !to) {
      return;
    }
    if (plan_.port(*from).kind != plan_.port(*to).kind) {
      report_(ConfigurationError(written.where,
                                 kinds_differ(sender, plan_.port(*from).kind, plan_.text(*to))));
    }
    plan_.connections.push_back(
        {*from, *to, written.delay_ticks, written.where, written.channels, written.combination});
  }
  /// An input whose connection has a slip in its name is not said to have none.
  void finish() const {
    if (all_found_) {
      check_inputs(plan_, reached_, report_);
    }
  }

 private:
  std::optional<PlannedPortAddress> find(const std::string& written, Direction direction,
                                         const Location& where) {
    try {
      return find_port(plan_.elements, written, direction, where);
    } catch (const ConfigurationError& error) {
      all_found_ = false;
      report_(error);
      return std::nullopt;
    }
  }

  GraphPlan& plan_;
  const ErrorHandler& report_;
  Inputs reached_;
  bool all_found_ = true;
};

// A cycle of connections without delay among the elements that could not be ordered.
ConfigurationError cycle_error(const GraphPlan& plan, const std::vector<bool>& placed) {
  std::size_t at = 0;
  while (placed[at]) {
    ++at;
  }
  // Every unplaced element waits for another unplaced one: walking back must return somewhere.
  std::vector<std::size_t> walk;
  Location last;
  while (std::find(walk.begin(), walk.end(), at) == walk.end()) {
    walk.push_back(at);
    for (const PlannedConnection& connection : plan.connections) {
      if (connection.to.element == at && connection.delay_ticks == 0 &&
          !placed[connection.from.element]) {
        at = connection.from.element;
        last = connection.where;
        break;
      }
    }
  }
  std::string text = plan.elements[at].name;
  for (auto i = walk.rbegin(); i != walk.rend() && *i != at; ++i) {
    text += " -> " + plan.elements[*i].name;
  }
  return {last, with_code(Code::delay,
                          "the cycle {} -> {} has no delay; give one of its connections a delay "
                          "of at least 1 tick",
                          text, plan.elements[at].name)};
}

void order_elements(GraphPlan& plan, const ErrorHandler& report) {
  std::vector<std::size_t> waits_for(plan.elements.size(), 0);
  for (const PlannedConnection& connection : plan.connections) {
    waits_for[connection.to.element] += connection.delay_ticks == 0 ? 1 : 0;
  }
  std::vector<bool> placed(plan.elements.size(), false);
  for (bool progress = true; progress;) {
    progress = false;
    for (std::size_t e = 0; e < plan.elements.size(); ++e) {
      if (placed[e] || waits_for[e] != 0) {
        continue;
      }
      placed[e] = progress = true;
      plan.order.push_back(e);
      for (const PlannedConnection& connection : plan.connections) {
        if (connection.from.element == e && connection.delay_ticks == 0) {
          --waits_for[connection.to.element];
        }
      }
    }
  }
  if (plan.order.size() < plan.elements.size()) {
    report(cycle_error(plan, placed));
  }
}

}  // namespace

std::string_view usual_port(Direction direction) {
  return direction == Direction::input ? "in" : "out";
}

std::string GraphPlan::text(const PlannedPortAddress& address) const {
  return fmt::format("{}.{}", elements[address.element].name, port(address).name);
}

GraphPlan plan(const GraphDescription& description, const ErrorHandler& report) {
  if (description.tick < 1) {
    throw ConfigurationError(with_code(Code::out_of_bounds,
                                       "a tick of {} ns cannot be run; write for example 1 ms",
                                       description.tick));
  }
  bool good = true;
  const ErrorHandler tell = [&](const ConfigurationError& error) {
    good = false;
    report(error);
  };
  GraphPlan plan;
  plan.elements = planned_elements(description);
  Connector connector(plan, tell);
  for (const ConnectionDescription& written : description.connections) {
    connector.connect(written);
  }
  connector.finish();
  order_elements(plan, tell);
  if (good) {
    std::vector<PlannedInput> inputs = planned_inputs(plan, description);
    settle_widths(plan, inputs);
    for (const PlannedInput& input : inputs) {
      input.check_widths(tell);
    }
  }
  if (good) {
    check_node_widths(plan, tell);
  }
  return plan;
}

GraphPlan plan(const GraphDescription& description) {
  return plan(description, [](const ConfigurationError& error) { throw error; });
}

}  // namespace spikeloop
