// What spikeloop.Parameter says of a parameter, for C++.
#pragma once

#include <pybind11/pybind11.h>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop::python {

/// Of the tuple that Parameter.plain() gives.
ParameterDescription parameter_of(const pybind11::tuple& plain);

}  // namespace spikeloop::python
