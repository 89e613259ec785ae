// A script as a MUSIC program: music::Process, with the script between receiving and sending.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exchange.hpp"
#include "spikeloop/process/process.hpp"

namespace spikeloop::python {

/// A port as the script declares it. Width 0: as the file says.
struct DeclaredPort {
  std::string name;
  PortKind kind = PortKind::spikes;
  Direction direction = Direction::input;
  std::uint32_t width = 0;
};

class Host {
 public:
  /// MUSIC's Setup; then keys, widths and ports. `arguments` are the command line's.
  /// @throws Error as Process's calls; a width that is not the file's; several processes, unless
  /// `many_processes`.
  Host(std::vector<std::string> arguments, std::vector<DeclaredPort> ports,
       std::vector<ParameterDescription> parameters, bool many_processes);
  /// With a Process that is there already, beside a simulator that has MUSIC.
  Host(std::unique_ptr<music::Process> process, std::vector<DeclaredPort> ports,
       std::vector<ParameterDescription> parameters);
  ~Host();

  const music::Process& process() const { return *process_; }
  const Parameters& parameters() const { return parameters_; }
  /// Where the .music file lies, or the experiment from which it was made.
  const std::string& directory() const { return directory_; }
  /// What the section's `args` says, split into words, after the program's name.
  const std::vector<std::string>& arguments() const { return arguments_; }
  /// Of the declared ports, in their order.
  std::vector<std::uint32_t> widths() const;
  /// Whether the file connects each of them.
  const std::vector<bool>& connected() const { return connected_; }

  /// The next tick: its interval, and what arrived in it. Nothing when the run is over.
  std::optional<Interval> begin();
  const Inbox& inbox() const { return *inbox_; }
  Outbox& outbox() { return *outbox_; }
  /// Sends what is in the outbox.
  void end();
  /// After the last tick.
  void finish();

 private:
  void read(const std::vector<ParameterDescription>& parameters);
  void open(std::vector<DeclaredPort> ports);
  void check_kind(const DeclaredPort& port) const;
  std::uint32_t settled_width(const DeclaredPort& port, bool connected) const;
  void open_input(const EndpointPort& port, bool connected);
  void open_output(const EndpointPort& port, bool connected);
  std::string gathered(const EndpointPort& port);
  void make_graphs();

  std::unique_ptr<music::Process> process_;
  std::vector<std::string> arguments_;
  std::string directory_;
  Parameters parameters_;
  std::vector<EndpointPort> inputs_;
  std::vector<EndpointPort> outputs_;
  std::vector<std::uint32_t> widths_;
  std::vector<bool> connected_;
  std::vector<std::unique_ptr<NodeClass>> gatherings_;
  std::vector<std::unique_ptr<Source>> sources_;
  std::vector<std::unique_ptr<Sink>> sinks_;
  GraphDescription receiving_description_;
  GraphDescription sending_description_;
  std::unique_ptr<Inbox> inbox_;
  std::unique_ptr<Outbox> outbox_;
  std::optional<Graph> receiving_;
  std::optional<Graph> sending_;
  std::unique_ptr<music::Process::Loop> loop_;
};

}  // namespace spikeloop::python
