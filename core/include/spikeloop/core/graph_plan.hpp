// The checked form of a graph description: names resolved, widths known, nodes in order.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error_handler.hpp"
#include "spikeloop/core/graph.hpp"

namespace spikeloop {

struct PlannedPort {
  std::string name;
  PortKind kind = PortKind::signal;
  Direction direction = Direction::input;
  WidthRule rule{};
  std::uint32_t width = 0;  ///< 0 until it is known
};

/// The port that is meant when several have this direction and none is named: "in", "out".
std::string_view usual_port(Direction direction);

/// A source, node or sink alike.
struct PlannedElement {
  std::string name;
  std::vector<PlannedPort> ports;
  Location where{};
};

struct PlannedPortAddress {
  std::size_t element = 0;
  std::size_t port = 0;
};

struct PlannedConnection {
  PlannedPortAddress from;
  PlannedPortAddress to;
  std::uint32_t delay_ticks = 0;
  Location where{};
  ChannelRange channels{};
  Combination combination = Combination::alone;
};

/// Elements are listed sources first, then nodes, then sinks, each in the description's order.
struct GraphPlan {
  std::vector<PlannedElement> elements;
  std::vector<PlannedConnection> connections;
  std::vector<std::size_t> order;  ///< elements in an order in which they can be advanced

  const PlannedPort& port(const PlannedPortAddress& address) const {
    return elements[address.element].ports[address.port];
  }
  /// "node.port"
  std::string text(const PlannedPortAddress& address) const;
};

/// Makes no node: classes of nodes may have no factory.
/// @throws ConfigurationError as Graph's constructor says.
GraphPlan plan(const GraphDescription& description);

/// The same, but tells everything that is wrong: names, kinds, inputs and cycles, and when these
/// are right, widths. The plan is not to be used when something was told.
GraphPlan plan(const GraphDescription& description, const ErrorHandler& report);

}  // namespace spikeloop
