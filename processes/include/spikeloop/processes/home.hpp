// A home directory for users without one.
#pragma once

namespace spikeloop {

/// Sets HOME for this program and its children if neither HOME nor the user database contains a
/// home directory, and MPLCONFIGDIR if the home directory is not writable. Without a home directory
/// mpirun crashes, and matplotlib cannot be imported. The directory is the user's own:
/// /tmp/spikeloop-home-UID. Call it before any other thread runs.
void provide_home();

}  // namespace spikeloop
