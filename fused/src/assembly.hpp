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
#include "spikeloop/fused/other_processes.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/fused/transport.hpp"

namespace spikeloop::bag {
class Recorder;
}
namespace spikeloop::record {
class Recorder;
}

namespace spikeloop::fused {

class LiveView;

/// What the graph meets at its boundary.
struct Surroundings {
  Transport& transport;
  OtherProcesses* others = nullptr;  ///< none: there are no other processes
  /// Whose nodes are in the graph.
  std::string process{};
  LiveView* view = nullptr;  ///< none: nobody watches
};

class Assembly {
 public:
  /// @throws Error: an endpoint cannot be made, a recording cannot be written.
  Assembly(const experiment::Experiment& experiment, const Surroundings& surroundings,
           const RunOptions& options);
  ~Assembly();

  Graph& graph() { return *graph_; }
  std::vector<ros_command::CommandEndpoint*> commands() const;
  void stop_robot(command::StopReason reason);
  /// Closes the recordings; what they lost is warned of and counted, and the last such sentence is
  /// in `error`.
  nlohmann::json close_recordings(std::string& error);
  /// What the commands measured.
  nlohmann::json summary() const;

 private:
  void add_node(const experiment::Node& node);
  bool begins_anew(const experiment::Node& node) const;
  void add_command(const experiment::Node& node);
  bool is_here(const std::string& end) const;
  void add_edge(const experiment::Connection& edge);
  void connect(const std::string& from, const std::string& to, const experiment::Connection& edge,
               std::uint32_t delay);
  std::uint32_t waiting(const experiment::Connection& edge) const;
  std::string end_here(const std::string& end) const;
  std::string source_of(const experiment::Connection& edge);
  void send(const experiment::Connection& edge);
  void open_bag();
  topics::Keep keep_messages(const experiment::Node& node);
  void record();
  using Observe = std::function<std::unique_ptr<Sink>(const std::string& end, PortKind kind,
                                                      std::uint32_t width)>;
  void observe(std::string_view observer, const Observe& observe);
  void show();
  void take_latency(const experiment::Node& node, ros_command::CommandEndpoint& command);
  record::Recorder& recorder_of(const experiment::Node& node);
  void add_recording(const std::string& from, const std::string& name, std::unique_ptr<Sink> sink);

  const experiment::Experiment& experiment_;
  Transport& transport_;
  OtherProcesses* others_;
  std::string process_;
  LiveView* view_;
  std::string folder_;  ///< of the recordings; empty: none
  WriteFailures& failures_;
  GraphDescription description_;
  std::unique_ptr<bag::Recorder> messages_;  ///< before those who keep messages in it
  std::vector<std::unique_ptr<Source>> sources_;
  std::vector<std::unique_ptr<Sink>> sinks_;  ///< that lead to other processes
  std::set<std::string> outside_;             ///< elements that are ends of other processes
  std::vector<std::unique_ptr<ros_command::CommandEndpoint>> commands_;
  std::vector<std::unique_ptr<NodeClass>> classes_;
  std::map<std::string, std::unique_ptr<record::Recorder>> recorders_;  ///< by node
  std::vector<std::unique_ptr<Sink>> recording_sinks_;
  std::optional<Graph> graph_;
};

/// Whether an element of the graph is one of those that record.
bool is_recording(std::string_view element);
/// Whether an end is one of those that send to other processes, which count what reaches their
/// nodes.
bool is_sent(std::string_view end);
/// "wheels.commands" of "wheels sender.commands", "brain.out" of "brain out.out": a node's several
/// elements have its name in a file.
std::string name_in_file(std::string_view element);

}  // namespace spikeloop::fused
