// Connections between nodes: those that exist, and those that the master's list implies.
#pragma once

#include <compare>
#include <optional>
#include <string>
#include <vector>

#include "ask.hpp"

namespace spikeloop::ros1 {

/// As Session::has_publishers.
bool has_publishers(const std::string& self, const std::string& topic);

/// As Session::is_connected_to_publisher.
bool is_connected_to_publisher(const std::string& self, const std::string& topic);

/// As Session::publishers_are_connected.
/// @param self name of this node
bool all_publishers_connected(const std::string& self, const std::string& topic);

/// Another node of one of this node's topics.
struct Link {
  bool is_publisher = false;  ///< else it subscribes
  std::string topic;
  std::string node;
  std::string uri;  ///< "http://robot:45123/"

  auto operator<=>(const Link&) const = default;
};

/// Nodes that the master lists for the topics of this node, and that are not connected to it.
/// @throws XmlRpc::XmlRpcException: the answer has another form than a master's
std::vector<Link> missing_links(const std::string& self);

/// Message type of the node at the other end of a link. Empty if it takes every type, or does not
/// answer. Nodes with other types have no connection.
std::string type_of(const std::string& self, const Link& link);

/// Address from which a publisher sends its messages; nullopt if it does not answer.
std::optional<Address> data_address(const std::string& self, const Link& publisher);

}  // namespace spikeloop::ros1
