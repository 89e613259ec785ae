// Scripts in Python that take part in jobs: read as text, never started to be looked at.
#pragma once

#include <string>

namespace spikeloop {

/// What a script takes part by: lines that import the package spikeloop.
enum class ScriptHost {
  none,   ///< no line does
  other,  ///< spikeloop, spikeloop.neuron, spikeloop.brian
  nest    ///< spikeloop.nest, whose times are rounded
};
/// @throws FileError for a file that cannot be read.
ScriptHost host_in_script(const std::string& path);

}  // namespace spikeloop
