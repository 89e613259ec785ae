// Parameter declarations as text for `--help`.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// A line a parameter in aligned columns: name, type or unit, default ("required" without), bounds
/// or choices, text. Ends with a line end; empty for no parameters. Lists and maps that have keys
/// follow, each with an example and a table of its keys.
///
///   rate_max  Hz      100       >= 0  rate at input 1
///   weights   weights required        one row an output
std::string parameter_text(const std::vector<ParameterDescription>& parameters);

}  // namespace spikeloop
