// Plug-ins that are no libraries: which library makes node classes of them, and where it is.
#pragma once

#include <string>

#include "spikeloop/core/plugin.h"

namespace spikeloop {

/// Whether files with this ending are for a loader.
bool has_loader(const std::string& path);

/// Whether the file looks as if it defined node classes.
/// @throws ConfigurationError as load_by_loader.
bool defines_nodes(const std::string& path);

/// The classes of a file; they live until the program ends.
/// @throws ConfigurationError with the loader's message, or when the loader is not there.
const spikeloop_plugin& load_by_loader(const std::string& path);

}  // namespace spikeloop
