// Node classes as text: all of it comes from their descriptions.
#pragma once

#include <string>

#include "spikeloop/core/registry.hpp"

namespace spikeloop::app {

/// A line a class, in groups: encoders, decoders, adapters.
std::string class_list(const Registry& registry);

/// Ports and parameters.
std::string tables(const NodeDescription& description);

/// Ports, parameters and how to run it.
std::string class_text(const NodeDescription& description);

/// All classes as a page of Markdown.
std::string reference_page(const Registry& registry);

}  // namespace spikeloop::app
