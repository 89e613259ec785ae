// From an experiment to a graph with everything that belongs to it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/graph.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/fused/simulators.hpp"
#include "spikeloop/fused/transport.hpp"

namespace spikeloop::bag {
class Recorder;
}
namespace spikeloop::record {
class Recorder;
}

namespace spikeloop::fused {

/// What the graph meets at its rim.
struct Surroundings {
  Transport& transport;
  Simulators* simulators = nullptr;  ///< none: the experiment has none
};

class Assembly {
 public:
  /// @param folder where what nodes put out is recorded, and messages; empty: nowhere
  /// @throws Error: an endpoint cannot be made, a recording cannot be written.
  Assembly(const experiment::Experiment& experiment, const Surroundings& surroundings,
           const std::string& folder);
  ~Assembly();

  Graph& graph() { return *graph_; }
  void stop_robot(command::StopReason reason);
  /// Closes the recordings; what they lost is warned of and counted, and the last such sentence is
  /// in `error`.
  nlohmann::json close_recordings(std::string& error);
  /// What the commands measured.
  nlohmann::json summary() const;

 private:
  void add_part(const experiment::Part& part);
  void add_command(const experiment::Part& part);
  /// The ports of a command that watch what it depends on.
  void add_watched(const experiment::Part& part);
  /// An output in the graph: a simulator's is an element of its own.
  std::string end_of(const experiment::Link& link) const;
  void add_links();
  /// A connection from a simulator, or to one.
  void add_link_outside(const experiment::Link& link);
  void open_bag(const std::string& folder);
  topics::Keep keep_messages(const experiment::Part& part);
  void record(const std::string& folder);
  void record_latency(const experiment::Part& part, ros_command::CommandEndpoint& command,
                      const std::string& folder);
  record::Recorder& recorder_of(const experiment::Part& part, const std::string& folder);
  void add_recording(const std::string& from, const std::string& name, std::unique_ptr<Sink> sink);

  const experiment::Experiment& experiment_;
  Transport& transport_;
  Simulators* simulators_;
  GraphDescription description_;
  std::unique_ptr<bag::Recorder> messages_;  ///< before those who keep messages in it
  std::vector<std::unique_ptr<Source>> sources_;
  std::vector<std::unique_ptr<Sink>> sinks_;  ///< that lead to simulators
  std::set<std::string> simulator_outputs_;   ///< elements that have their source
  std::vector<std::unique_ptr<ros_command::CommandEndpoint>> commands_;
  std::vector<std::unique_ptr<NodeClass>> classes_;
  std::map<std::string, std::unique_ptr<record::Recorder>> recorders_;  ///< by node
  std::vector<std::unique_ptr<Sink>> recording_sinks_;
  std::optional<Graph> graph_;
};

/// Whether an element of the graph is one of those that record.
bool is_recording(std::string_view element);
/// "wheels.commands" of "wheels sender.commands", "brain.out" of "brain out.out": a node's several
/// elements have its name in a file.
std::string name_in_file(std::string_view element);

}  // namespace spikeloop::fused
