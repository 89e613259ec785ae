// The node contract. A node sees an interval (t, t+dt], its input ports, and writes its output
// ports. It owns no thread, clock, MPI, file or ROS, and never prints. State advances at revisions
// and spikes, in closed form, never by adding up ticks. docs/architecture.md has the whole text.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/random.hpp"
#include "spikeloop/core/signal.hpp"
#include "spikeloop/core/weights.hpp"

namespace spikeloop {

enum class PortKind : std::uint32_t { signal = SPIKELOOP_SIGNAL, spikes = SPIKELOOP_SPIKES };
enum class Direction : std::uint32_t { input = SPIKELOOP_INPUT, output = SPIKELOOP_OUTPUT };

/// How wide a port is: as its connection says, a fixed number, or as wide as another port.
struct WidthRule {
  enum class Kind : std::uint32_t {
    free = SPIKELOOP_WIDTH_FREE,
    fixed = SPIKELOOP_WIDTH_FIXED,
    same_as = SPIKELOOP_WIDTH_SAME
  };
  Kind kind = Kind::free;
  std::uint32_t value = 0;  ///< fixed: the width; same_as: the index of the other port

  static WidthRule fixed(std::uint32_t width) { return {Kind::fixed, width}; }
  static WidthRule same_as(std::uint32_t port) { return {Kind::same_as, port}; }
};

/// Neurons with one name: neighbouring channels of a port.
struct Population {
  std::string name;
  std::uint32_t size = 0;
};

struct PortDescription {
  std::string name;
  PortKind kind = PortKind::signal;
  Direction direction = Direction::input;
  WidthRule width{};
  std::string text;                       ///< one line
  std::string unit = "1";                 ///< of a signal's values
  std::vector<Population> populations{};  ///< of spikes, in the order of the channels; empty: one
  std::vector<std::string> channels{};    ///< of a signal: names of its channels; empty: none
};

/// How a node goes back to the state of the beginning. A plug-in's never does: it may have a state,
/// or have learned something, of which nothing is known here.
enum class Reset {
  never,
  by_itself,  ///< Node::reset
  made_again  ///< by its factory; it leaves no results and learns nothing
};

/// Everything that is known of a class of nodes without making one.
struct NodeDescription {
  std::string name;
  std::string text;    ///< one line
  std::string source;  ///< the paper's equation or the manual's section
  std::vector<PortDescription> ports;
  std::vector<ParameterDescription> parameters;
  /// Nodes of the class heed NodeSetup::share, so that processes and threads can share the work.
  bool shareable = false;
  Reset reset = Reset::never;
};

/// One of `parts` equal parts of a node's output channels.
struct Share {
  std::uint32_t index = 0;
  std::uint32_t parts = 1;

  std::uint32_t begin(std::uint32_t width) const {
    return static_cast<std::uint32_t>(std::uint64_t{width} * index / parts);
  }
  std::uint32_t end(std::uint32_t width) const {
    return static_cast<std::uint32_t>(std::uint64_t{width} * (index + 1) / parts);
  }
  std::uint32_t count(std::uint32_t width) const { return end(width) - begin(width); }
};

/// What a node is made from. `widths` runs parallel to the description's ports.
struct NodeSetup {
  std::string name;  ///< section label or name in the experiment; keys the random streams
  std::uint64_t seed = 1;
  Parameters parameters;
  std::vector<std::uint32_t> widths;
  /// The output channels to compute, for all of the inputs. Every channel's result is the same
  /// whatever the share; what concerns no channel is counted by share 0 alone.
  Share share{};
  std::uint64_t episode = 1;  ///< counts how often the node has begun

  /// Keys random numbers that should differ from one episode to the next. `seed` keys all others:
  /// which neurons there are stays, what they do by chance does not come again.
  std::uint64_t noise_seed() const { return episode_seed(seed, episode); }
};

/// Something a node counted: clipped inputs, late spikes, ... Names are snake_case.
struct Counter {
  std::string name;
  std::uint64_t value = 0;
};

/// What a node leaves behind when the run is over: a table, and the name of the file that the
/// process writes it to.
struct Result {
  std::string file;
  WeightTable table;
};

/// Weights of synapses that learn, as they stand during the run.
struct LearningWeights {
  std::string name;                 ///< "FROM.TO", the projection's populations
  std::span<const double> weights;  ///< of all synapses; valid until the next call
};

class Node {
 public:
  Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  virtual ~Node() = default;

  /// Advances over step.interval(). Consecutive calls have adjoining intervals.
  /// @throws Error, or anything derived from std::exception, to end the run.
  virtual void step(const Step& step) = 0;

  /// Totals since the beginning of the run.
  virtual std::vector<Counter> counters() const { return {}; }

  /// A parameter that its description calls changeable has another value from the begin of the next
  /// step on; the value is within the parameter's bounds.
  virtual void change(std::string_view /*parameter*/, double /*value*/) {}

  /// Back to the state of the beginning, between two steps, of which the next one begins now; what
  /// was learned stays. Of classes with Reset::by_itself.
  virtual void reset(TimeNs /*now*/) {}

  /// Between two steps, for those who watch the run: changes nothing, and computes nothing. Weights
  /// that are brought up to date only now and then may be a second of simulated time old.
  virtual std::vector<LearningWeights> learning_weights() const { return {}; }

  /// Called once, when the run is over.
  virtual std::vector<Result> results() { return {}; }
};

using NodeFactory = std::function<std::unique_ptr<Node>(const NodeSetup&)>;

/// A class of nodes. The factory throws ConfigurationError when widths and parameters do not fit.
struct NodeClass {
  NodeDescription description;
  NodeFactory create;
};

}  // namespace spikeloop
