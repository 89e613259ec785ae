// The boundary of a graph: sources and sinks with the same ports as nodes, owned by the process.
// An endpoint may have threads, files, ROS and MPI; receive() and send() are called by the loop.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// A port of an endpoint with its width, which the endpoint knows.
struct EndpointPort {
  std::string name;
  PortKind kind = PortKind::signal;
  std::uint32_t width = 0;
};

/// Brings data in: a ROS topic, a MUSIC input port, a file.
class Source {
 public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;
  virtual std::vector<EndpointPort> ports() const = 0;

  /// Fills its outputs for step.interval() with what is known when the clock shows its begin.
  /// Must not wait. Spikes stamped after the interval are held back by the graph until their time;
  /// those at or before its begin are passed on and counted as late.
  virtual void receive(const Step& step) = 0;
  virtual std::vector<Counter> counters() const { return {}; }
};

/// Takes data out: a ROS topic, a MUSIC output port, a file.
class Sink {
 public:
  Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  virtual ~Sink() = default;
  virtual std::vector<EndpointPort> ports() const = 0;

  /// Takes its inputs of step.interval(), after every node has stepped. A signal's value is the
  /// one at the interval's end.
  virtual void send(const Step& step) = 0;
  virtual std::vector<Counter> counters() const { return {}; }
};

}  // namespace spikeloop
