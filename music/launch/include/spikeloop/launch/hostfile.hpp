// Open MPI's file of hosts, which mpirun itself complains of in twenty lines.
#pragma once

#include <string>

namespace spikeloop::launch {

/// "HOST [slots=N] [max_slots=N]" a line, '#' begins a comment (man mpirun, "Specifying Hosts").
/// @throws FileError when it cannot be read
/// @throws ConfigurationError for a line that mpirun would not understand, or when there is no host
void check_hostfile(const std::string& path);

}  // namespace spikeloop::launch
