// The node classes of a file as the plain data of plugin.h.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "interpreter.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/plugin.hpp"

namespace spikeloop::python {

/// A node class of a file: what `create` is given back as setup.node_class.
class PythonClass : public spikeloop_node_class {
 public:
  /// Of a Definition of the package. Needs the lock.
  PythonClass(pybind11::object definition, const spikeloop_host& host);

  const pybind11::object& definition() const { return definition_; }
  const NodeDescription& description() const { return plain_.description(); }
  const spikeloop_host& host() const { return host_; }

 private:
  pybind11::object definition_;
  plugin::PlainDescription plain_;
  const spikeloop_host& host_;
};

/// A file and its classes; never destroyed.
class PythonFile {
 public:
  /// Runs the file. Needs the lock.
  /// @throws pybind11::error_already_set with whatever it raised.
  PythonFile(const std::string& path, const spikeloop_host& host);
  const spikeloop_plugin* plain() const { return &plain_; }

 private:
  std::deque<PythonClass> classes_;
  std::vector<const spikeloop_node_class*> pointers_;
  spikeloop_plugin plain_{};
};

}  // namespace spikeloop::python
