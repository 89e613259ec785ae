// What to do with an error when others may follow.
#pragma once

#include <functional>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

/// Takes an error: throws it, or keeps it so that the others are found, too.
using ErrorHandler = std::function<void(const ConfigurationError&)>;

}  // namespace spikeloop
