// The library that runs Python: what it has beside node classes.
#pragma once

#include <string>

#include "spikeloop/core/plugin.h"

namespace spikeloop {

/// A function of the library, which is opened when the first one is asked for, and stays.
/// @param for_what "environment 'x.py:make'"
/// @throws ConfigurationError when the library is not installed, or is another version's.
void* python_function(const char* name, const std::string& for_what);

/// What the library logs by.
const spikeloop_host& python_host();

}  // namespace spikeloop
