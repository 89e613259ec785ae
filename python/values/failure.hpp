// The exception with which the libraries of the Python package report an Error of Spikeloop.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>

#include "spikeloop/core/error.hpp"

namespace spikeloop::python {

/// Adds the exception `Failure` to a module, and raises it for every Error. Its arguments are
/// message and exit code; spikeloop.SpikeloopError is made from them.
inline void register_failure(pybind11::module_& module) {
  namespace py = pybind11;
  static const py::exception<Error> failure(module, "Failure");
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) {
        std::rethrow_exception(thrown);
      }
    } catch (const Error& error) {
      PyErr_SetObject(failure.ptr(), py::make_tuple(error.what(), error.exit_code()).ptr());
    }
  });
}

}  // namespace spikeloop::python
