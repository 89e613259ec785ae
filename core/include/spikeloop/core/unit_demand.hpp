// Numbers of experiment files carry their unit.
#pragma once

#include <string>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// "1 has no unit; write for example  timeout: 1 s" of a bare number other than 0 in the place of
/// one with a unit; else empty.
std::string missing_unit(const ParameterDescription& parameter, const WrittenValue& written);

/// @param what whose key it is, "node 'a'".
/// @throws ConfigurationError when missing_unit() has something to say.
void demand_unit(const std::string& what, const ParameterDescription& parameter,
                 const WrittenValue& written);

}  // namespace spikeloop
