// `function`: expressions of the inputs, written in the section.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// out[k] = the k-th expression of the text `function`, in the language of `Expressions`, for
/// example "sin(pi*x0); x0*x1". A result that is NaN or infinite is treated as `not_finite` says:
/// hold, that output keeps its last value (`out` is invalid until every output has had one); zero;
/// error.
NodeClass function_class();

}  // namespace spikeloop
