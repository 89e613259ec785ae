// The Python interpreter inside a program of ours.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>

#include "spikeloop/core/plugin.h"

namespace spikeloop::python {

/// Holds the interpreter's lock; the interpreter must have been started.
class Lock {
 public:
  Lock() : state_(PyGILState_Ensure()) {}
  ~Lock() { PyGILState_Release(state_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  PyGILState_STATE state_;
};

/// Starts the interpreter, once in the life of the program, and leaves its lock free. It is never
/// finalized: NumPy and others cannot be loaded a second time.
/// @throws std::runtime_error with the reason.
void start_interpreter();

/// The same, and imports the package.
/// @throws std::runtime_error with what to install.
void start_package();

/// The package's module node_host. Needs the lock.
/// @throws pybind11::error_already_set when it cannot be imported.
const pybind11::module_& node_host();

/// The message of an exception, in one line: where and what. The traceback goes to the log, a line
/// each, at this level. Needs the lock.
std::string described(const pybind11::error_already_set& error, const spikeloop_host& host,
                      std::uint32_t level);

/// `text`, as far as it fits.
void write_error(const std::string& text, char* error, std::uint64_t error_size);

}  // namespace spikeloop::python
