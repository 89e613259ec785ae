// The host's side of the plain-data border: classes that live in a shared library.
#pragma once

#include <string>

#include "spikeloop/core/node.hpp"
#include "spikeloop/core/plugin.h"

namespace spikeloop {

/// A node class whose functions are called across the border.
/// @throws ConfigurationError when the description is malformed (null names, bad indices).
NodeClass foreign_node_class(const std::string& path, const spikeloop_node_class* foreign);

}  // namespace spikeloop
