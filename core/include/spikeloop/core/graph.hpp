// A graph of nodes and endpoints joined by connections with declared delays, and its advance by one
// interval. The loop around it (wait, receive, step, exchange, send) belongs to the process.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// The channels [begin, end) of a sender.
struct ChannelRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;  ///< 0: to the sender's last channel

  bool all() const { return begin == 0 && end == 0; }
  /// How many there are when the sender has `width` channels; 0: `width` is 0 and `end`, too.
  std::uint32_t count(std::uint32_t width) const;
  /// "[0:50]", "[7]", "[50:]"; empty for all channels.
  std::string text() const;
};

/// How a connection shares its input with the connection that is listed before it.
enum class Combination : std::uint32_t {
  alone,     ///< it does not: the input's first or only connection
  appended,  ///< its channels follow those of the connections before
  added      ///< its signals are added to those before, its spikes merged, channel by channel
};

/// "node.port"; the port may be left out where the node has only one of that direction, or where
/// `in`, or `out`, is meant.
struct ConnectionDescription {
  std::string from;
  std::string to;
  std::uint32_t width = 0;  ///< of the input; 0: as the ports say
  /// Whole ticks. A delay of d moves spikes and breakpoints by d ticks: a spike stamped s arrives
  /// stamped s + d * tick.
  std::uint32_t delay_ticks = 0;
  Location where{};       ///< of `to`
  Location where_from{};  ///< empty: as `where`
  ChannelRange channels{};
  /// Connections into one input are listed one after another. The first one is `alone`, all others
  /// are appended, or all others are added.
  Combination combination = Combination::alone;
  std::uint32_t sender_width = 0;  ///< 0: as the ports say
};

/// What a graph is made from. Pointers must outlive the graph.
struct GraphDescription {
  struct NodeEntry {
    std::string name;
    const NodeClass* node_class = nullptr;
    Parameters parameters;
    Location where{};
    Share share{};             ///< of this process
    unsigned threads = 1;      ///< that share it again
    bool begins_anew = false;  ///< Graph::reset works although the class has Reset::made_again
  };
  struct SourceEntry {
    std::string name;
    Source* source = nullptr;
  };
  struct SinkEntry {
    std::string name;
    Sink* sink = nullptr;
  };

  TimeNs tick = 0;
  std::uint64_t seed = 1;
  std::vector<NodeEntry> nodes;
  std::vector<SourceEntry> sources;
  std::vector<SinkEntry> sinks;
  std::vector<ConnectionDescription> connections;
};

/// The output "node.port" of a node; null for that of a source, whose ports are not described.
const PortDescription* find_output(const GraphDescription& description, std::string_view end);

/// What passed a connection since the beginning of the run.
struct ConnectionReport {
  std::string from;
  std::string to;
  std::uint64_t sent = 0;    ///< by the sender, also on channels that the connection leaves out
  std::uint64_t spikes = 0;  ///< on the channels of the connection
  std::uint64_t late = 0;    ///< of these, stamped at or before the begin of their interval
};

class Graph {
 public:
  /// Checks names, kinds, widths, cycles; then makes the nodes.
  /// @throws ConfigurationError: unknown node or port (did you mean), two connections into one
  /// input that are not combined, input without connection, channels that the sender does not have,
  /// widths that differ (both named), a cycle whose delays add up to nothing (its nodes named), a
  /// share of a node whose class cannot share.
  explicit Graph(const GraphDescription& description);
  ~Graph();
  Graph(Graph&&) noexcept;
  Graph& operator=(Graph&&) noexcept;

  /// Advances by one tick: sources, nodes in order of dependence, sinks.
  /// @throws NodeError with the node's name when a node throws, stamps a spike outside the interval
  /// or names a channel its port does not have.
  void step();

  /// As Node::change(). False: it has no such node. @throws NodeError with the node's name.
  bool change(std::string_view node, std::string_view parameter, double value);

  /// As Node::reset(), now; what is on its way to the node, or from it, gets lost. A node that is
  /// made again counts time from 0 and has no output until it writes one. @throws NodeError with
  /// the node's name.
  void reset(std::string_view node);

  /// The begin of the next interval.
  TimeNs time() const;
  TimeNs tick() const;

  std::vector<ConnectionReport> connections() const;
  /// Counters of nodes and endpoints, named "node.counter".
  std::vector<Counter> counters() const;
  /// As Node::learning_weights() of all nodes; the names are "NODE/FROM.TO".
  std::vector<LearningWeights> learning_weights() const;
  /// What its nodes leave behind; the files are named NODE.FILE.
  std::vector<Result> results();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop
