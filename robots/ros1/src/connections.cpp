#include "connections.hpp"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpc.h>

#include <vector>

namespace spikeloop::ros1 {
namespace {

using XmlRpc::XmlRpcValue;

/// Type of a subscriber that takes every type, such as rostopic.
constexpr const char* kAnyType = "*";

/// Indices of the lists in the master's answer.
enum class Side { publishers = 0, subscribers = 1 };

/// Names of the nodes that publish a topic, or subscribe to it.
std::vector<std::string> nodes_of(const std::string& self, const std::string& topic, Side side) {
  XmlRpcValue request;
  XmlRpcValue response;
  XmlRpcValue state;  // publishers, subscribers, services
  request[0] = self;
  std::vector<std::string> nodes;
  if (!ros::master::execute("getSystemState", request, response, state, false)) {
    return nodes;
  }
  XmlRpcValue& topics = state[static_cast<int>(side)];
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

/// Answer of a node to a call of its API; of another type when it does not answer.
XmlRpcValue ask_node(const std::string& self, const std::string& node, const char* call) {
  XmlRpcValue request;
  XmlRpcValue response;
  XmlRpcValue uri;
  request[0] = self;
  request[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", request, response, uri, false) ||
      !ros::network::splitURI(static_cast<std::string&>(uri), host, port)) {
    return {};
  }
  const auto& manager = ros::XMLRPCManager::instance();
  XmlRpc::XmlRpcClient* client = manager->getXMLRPCClient(host, static_cast<int>(port), "/");
  XmlRpcValue asker;
  XmlRpcValue answer;  // status, its text, the value
  asker[0] = self;
  const bool answered = client->execute(call, asker, answer);
  manager->releaseXMLRPCClient(client);
  return answered && answer.getType() == XmlRpcValue::TypeArray && answer.size() == 3
             ? answer[2]
             : XmlRpcValue();
}

/// A connection is [id, the other's name, "o" for out, transport, topic, ...].
bool has_connection(XmlRpcValue connections, const std::string& subscriber,
                    const std::string& topic) {
  if (connections.getType() != XmlRpcValue::TypeArray) {
    return false;
  }
  for (int i = 0; i < connections.size(); ++i) {
    XmlRpcValue& connection = connections[i];
    if (static_cast<std::string&>(connection[2]) == "o" &&
        static_cast<std::string&>(connection[1]) == subscriber &&
        static_cast<std::string&>(connection[4]) == topic) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool has_publishers(const std::string& self, const std::string& topic) {
  try {
    return !nodes_of(self, topic, Side::publishers).empty();
  } catch (const XmlRpc::XmlRpcException&) {
    return false;  // an answer of another form than ROS's
  }
}

bool publishers_know(const std::string& self, const std::string& topic) {
  try {
    const std::vector<std::string> nodes = nodes_of(self, topic, Side::publishers);
    for (const std::string& node : nodes) {
      if (!has_connection(ask_node(self, node, "getBusInfo"), self, topic)) {
        return false;
      }
    }
    return !nodes.empty();
  } catch (const XmlRpc::XmlRpcException&) {
    return false;  // an answer of another form than ROS's
  }
}

std::vector<topics::Partner> subscribers(const std::string& self, const std::string& topic) {
  std::vector<topics::Partner> partners;
  try {
    for (const std::string& node : nodes_of(self, topic, Side::subscribers)) {
      XmlRpcValue topics = ask_node(self, node, "getSubscriptions");  // [topic, type], ...
      const int count = topics.getType() == XmlRpcValue::TypeArray ? topics.size() : 0;
      for (int i = 0; i < count; ++i) {
        const auto& type = static_cast<std::string&>(topics[i][1]);
        if (static_cast<std::string&>(topics[i][0]) == topic && type != kAnyType) {
          partners.push_back({.node = node, .type = type});
        }
      }
    }
  } catch (const XmlRpc::XmlRpcException&) {
    // An answer of another form than ROS's: the nodes before it are known.
  }
  return partners;
}

}  // namespace spikeloop::ros1
