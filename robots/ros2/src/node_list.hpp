// What `ros2 node list` and `ros2 node info` know of this process, and the names of other nodes.
#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graph.hpp"
#include "raw_type.hpp"
#include "spikeloop/ros2/names.hpp"

namespace spikeloop::ros2 {

using Gid = dds_guid_t;  ///< an endpoint's or participant's identity, 16 bytes

/// The bytes of an identity in messages of a distribution of ROS 2: 24 until Humble, 16 since Iron;
/// nothing for a name that is none.
std::optional<std::size_t> gid_bytes_of(const std::string& distribution);

/// rmw_dds_common/ParticipantEntitiesInfo: a participant with one node, as XCDR1.
std::vector<std::byte> node_message(const Gid& participant, const NodeIdentity& node,
                                    std::span<const Gid> readers, std::span<const Gid> writers,
                                    std::size_t gid_bytes);

struct NodeEndpoints {
  std::string name;  ///< "/base"
  std::vector<Gid> endpoints;
};
/// The nodes of such a message, whatever the length of an identity is in it. Empty if it cannot be
/// read.
std::vector<NodeEndpoints> read_nodes(std::span<const std::byte> message);

/// Tells ROS 2 which endpoints are this node's, once it is known how long an identity is: a message
/// of the wrong length harms nodes of ROS 2. The environment's ROS_DISTRO says it, or the nodes
/// that are there; where these do not agree, nothing is told.
class NodeList {
 public:
  NodeList(dds_entity_t participant, const RawTopic& topic, Graph& graph, Dispatcher& dispatcher,
           const NodeIdentity& node, const std::string& distribution);
  ~NodeList();
  NodeList(const NodeList&) = delete;
  NodeList& operator=(const NodeList&) = delete;

  void add_reader(dds_entity_t reader);
  void add_writer(dds_entity_t writer);
  void remove(dds_entity_t endpoint);
  /// "/base": name of the node that has a reader or writer. Empty if it is unknown.
  std::string node_of(const Gid& endpoint) const;

  static constexpr const char* kTopic = "ros_discovery_info";
  static constexpr const char* kType = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

 private:
  struct Entry {
    dds_entity_t endpoint;
    Gid gid;
    bool writes;
  };

  void hear_of(const Writer& writer);
  void take_names();
  void add(dds_entity_t endpoint, bool writes);
  void begin();
  void tell();

  dds_entity_t participant_;
  const RawTopic& topic_;
  Graph& graph_;
  NodeIdentity node_;
  Gid own_;
  mutable std::mutex mutex_;
  std::optional<std::size_t> gid_bytes_;
  bool disagreed_ = false;
  dds_entity_t writer_ = 0;
  std::vector<Entry> entries_;
  Graph::Listener listener_;
  Dispatcher& dispatcher_;
  dds_entity_t reader_;
  dds_entity_t arrived_;  ///< a read condition
  /// Nodes of the other participants by the writer of their list.
  std::map<dds_instance_handle_t, std::vector<NodeEndpoints>> others_;
  Dispatcher::Ticket ticket_;
};

}  // namespace spikeloop::ros2
