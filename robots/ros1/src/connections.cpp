#include "connections.hpp"

#include <fmt/format.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/topic_manager.h>
#include <ros/xmlrpc_manager.h>
#include <sys/socket.h>
#include <xmlrpcpp/XmlRpc.h>

#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace spikeloop::ros1 {
namespace {

using XmlRpc::XmlRpcValue;

/// Type of a subscriber that takes every type, such as rostopic.
constexpr const char* kAnyType = "*";

/// Lists publishers, subscribers and services. Not an array if the master does not answer.
XmlRpcValue system_state(const std::string& self) {
  XmlRpcValue request;
  XmlRpcValue response;
  XmlRpcValue state;
  request[0] = self;
  return ros::master::execute("getSystemState", request, response, state, false) ? state
                                                                                 : XmlRpcValue();
}

/// Names of the nodes of a topic.
/// @param topics publishers or subscribers of system_state()
std::vector<std::string> nodes_of(XmlRpcValue& topics, const std::string& topic) {
  std::vector<std::string> nodes;
  for (int i = 0; i < topics.size(); ++i) {
    if (static_cast<std::string&>(topics[i][0]) != topic) {
      continue;
    }
    for (int j = 0; j < topics[i][1].size(); ++j) {
      nodes.push_back(static_cast<std::string&>(topics[i][1][j]));
    }
  }
  return nodes;
}

std::vector<std::string> publishers_of(const std::string& self, const std::string& topic) {
  XmlRpcValue state = system_state(self);
  return state.valid() ? nodes_of(state[0], topic) : std::vector<std::string>();
}

/// URI of a node. Empty if the master does not list the node.
std::string uri_of(const std::string& self, const std::string& node) {
  XmlRpcValue request;
  XmlRpcValue response;
  XmlRpcValue uri;
  request[0] = self;
  request[1] = node;
  return ros::master::execute("lookupNode", request, response, uri, false)
             ? static_cast<std::string&>(uri)
             : std::string();
}

/// Calls a method of a node. The result is not valid if the node does not answer.
XmlRpcValue call(const std::string& uri, const char* method, const XmlRpcValue& request) {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) {
    return {};
  }
  const auto& manager = ros::XMLRPCManager::instance();
  XmlRpc::XmlRpcClient* client = manager->getXMLRPCClient(host, static_cast<int>(port), "/");
  XmlRpcValue answer;  // status, its text, value
  const bool answered = client->execute(method, request, answer);
  manager->releaseXMLRPCClient(client);
  return answered && answer.getType() == XmlRpcValue::TypeArray && answer.size() == 3
             ? answer[2]
             : XmlRpcValue();
}

/// Calls a method without arguments. The result is not valid if the node does not answer.
XmlRpcValue ask_node(const std::string& self, const std::string& node, const char* method) {
  XmlRpcValue request;
  request[0] = self;
  return call(uri_of(self, node), method, request);
}

/// roscpp lists a publisher as connected while it tries to connect. Its socket may be closed, and
/// its number used by another connection.
/// @param transport "TCPROS connection on port 37726 to [robot:42913 on socket 21]"
bool is_established(const std::string& transport) {
  constexpr std::string_view kSocket = " on socket ";
  const auto place = transport.rfind(kSocket);
  const auto port = transport.rfind(':', place);
  if (place == std::string::npos || port == std::string::npos) {
    return true;
  }
  const long socket = std::strtol(transport.c_str() + place + kSocket.size(), nullptr, 10);
  return port_of(static_cast<int>(socket), ::getpeername) ==
         std::strtol(transport.c_str() + port + 1, nullptr, 10);
}

/// Connections of this node, by the address on which it listens, because the one that this node
/// registers may be wrong. Not an array if it does not answer.
XmlRpcValue own_connections(const std::string& self) {
  XmlRpcValue request;
  request[0] = self;
  return call(fmt::format("http://127.0.0.1:{}/", ros::XMLRPCManager::instance()->getServerPort()),
              "getBusInfo", request);
}

/// A connection is [id, name ("o") or address ("i") of the other node, direction, transport, topic,
/// true, description].
bool has_connection(XmlRpcValue& connections, const std::string& other, const std::string& topic,
                    const char* direction = "o") {
  if (connections.getType() != XmlRpcValue::TypeArray) {
    return false;
  }
  for (int i = 0; i < connections.size(); ++i) {
    XmlRpcValue& connection = connections[i];
    if (static_cast<std::string&>(connection[2]) == direction &&
        static_cast<std::string&>(connection[1]) == other &&
        static_cast<std::string&>(connection[4]) == topic) {
      return std::string_view(direction) == "o" ||
             is_established(static_cast<std::string&>(connection[6]));
    }
  }
  return false;
}

}  // namespace

bool has_publishers(const std::string& self, const std::string& topic) {
  try {
    return !publishers_of(self, topic).empty();
  } catch (const XmlRpc::XmlRpcException&) {
    return false;  // not an answer of ROS
  }
}

bool is_connected_to_publisher(const std::string& self, const std::string& topic) {
  try {
    XmlRpcValue own = own_connections(self);
    for (const std::string& node : publishers_of(self, topic)) {
      if (has_connection(own, uri_of(self, node), topic, "i")) {
        return true;
      }
    }
  } catch (const XmlRpc::XmlRpcException&) {  // an answer of another form than ROS's
  }
  return false;
}

bool all_publishers_connected(const std::string& self, const std::string& topic) {
  try {
    const std::vector<std::string> nodes = publishers_of(self, topic);
    for (const std::string& node : nodes) {
      XmlRpcValue connections = ask_node(self, node, "getBusInfo");
      if (!has_connection(connections, self, topic)) {
        return false;
      }
    }
    return !nodes.empty();
  } catch (const XmlRpc::XmlRpcException&) {
    return false;  // not an answer of ROS
  }
}

std::string type_of(const std::string& self, const Link& link) {
  XmlRpcValue request;
  request[0] = self;
  XmlRpcValue topics =  // [topic, type], ...
      call(link.uri, link.is_publisher ? "getPublications" : "getSubscriptions", request);
  const int count = topics.getType() == XmlRpcValue::TypeArray ? topics.size() : 0;
  for (int i = 0; i < count; ++i) {
    const auto& type = static_cast<std::string&>(topics[i][1]);
    if (static_cast<std::string&>(topics[i][0]) == link.topic && type != kAnyType) {
      return type;
    }
  }
  return {};
}

std::vector<Link> missing_links(const std::string& self) {
  const auto& manager = ros::TopicManager::instance();
  XmlRpcValue state = system_state(self);
  XmlRpcValue own = own_connections(self);
  std::vector<Link> links;
  const auto add = [&](const std::string& topic, bool publishers) {
    for (const std::string& node : nodes_of(state[publishers ? 0 : 1], topic)) {
      if (node == self && !publishers) {
        continue;  // the subscription is the same link
      }
      const std::string uri = uri_of(self, node);
      if (!uri.empty() &&
          !has_connection(own, publishers ? uri : node, topic, publishers ? "i" : "o")) {
        links.push_back({publishers, topic, node, uri});
      }
    }
  };
  if (!state.valid() || !own.valid()) {
    return links;
  }
  std::vector<std::string> topics;
  manager->getSubscribedTopics(topics);
  for (const std::string& topic : topics) {
    add(topic, true);
  }
  topics.clear();
  manager->getAdvertisedTopics(topics);
  for (const std::string& topic : topics) {
    add(topic, false);
  }
  return links;
}

std::optional<Address> data_address(const std::string& self, const Link& publisher) {
  XmlRpcValue request;
  request[0] = self;
  request[1] = publisher.topic;
  request[2][0][0] = std::string("TCPROS");
  XmlRpcValue protocol = call(publisher.uri, "requestTopic", request);  // name, host, port
  if (protocol.getType() != XmlRpcValue::TypeArray || protocol.size() != 3) {
    return std::nullopt;
  }
  return Address{static_cast<std::string&>(protocol[1]),
                 static_cast<std::uint16_t>(static_cast<int&>(protocol[2]))};
}

}  // namespace spikeloop::ros1
