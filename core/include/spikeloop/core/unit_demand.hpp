// Numbers of experiment files carry their unit.
#pragma once

#include <string>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// True if the text is a plain number other than 0 and the parameter has a unit.
bool lacks_unit(const ParameterDescription& parameter, const std::string& text);

/// @param what whose key it is, "node 'a'"; empty: the caller says that
/// @throws ConfigurationError for a bare number other than 0 in the place of one with a unit.
void demand_unit(const std::string& what, const ParameterDescription& parameter,
                 const WrittenValue& written);

}  // namespace spikeloop
