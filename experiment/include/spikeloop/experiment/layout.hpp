// A layout spreads the nodes of an experiment over processes. Inside a process a connection is an
// edge of its graph, between processes it is one of MUSIC's, which takes time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {

/// "fused", "separate", "vision, control".
std::string name_of(const Layout& layout);
/// The name of a node's process, in any layout but the separate one.
std::string process_of(const Experiment& experiment, const std::string& node);
/// Whether a run has more than one process that MUSIC joins.
bool needs_music(const Experiment& experiment);
/// Whether the process has the robot's topics, or follows its clock.
bool meets_robot(const Experiment& experiment, const std::string& process);
/// Whether one process alone meets the robot.
bool one_meets_robot(const Experiment& experiment);
/// Whether a process waits for the clock; the others wait for data.
bool waits_for_clock(const Experiment& experiment, const std::string& process);

/// All that travels: the connections, and what a command hears beside its input, at its ports
/// `data_stamp` (when the message behind the data came), `sensor_0` ... (the same of every sensor
/// behind it) and `spikes_0` ... (`spike_timeout`).
/// @param experiment as with_layout_delays() gives it
std::vector<Connection> edges(const Experiment& experiment);
/// The first connection of this kind from another simulator into one; null: there is none. Between
/// two simulators there is no graph in which a connection could wait: the receiver waits, and with
/// it all of its inputs of this kind.
const Connection* from_simulator(const Experiment& experiment, const std::string& simulator,
                                 PortKind kind);
/// The whole ticks of an edge's delay that MUSIC has; the rest waits in the receiver's graph.
std::uint32_t music_delay(const Experiment& experiment, const Connection& edge);

/// "1 tick", "2 ticks".
std::string format_ticks(std::uint32_t ticks);
/// Every connection with the delay that it has in its layout.
/// @throws ConfigurationError for a delay that is less than what the layout takes.
Experiment with_layout_delays(const Experiment& experiment);

}  // namespace spikeloop::experiment
