// The node classes a program knows, built in or from plug-ins.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

class Registry {
 public:
  Registry();
  ~Registry();
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// @throws ConfigurationError when a class of that name is already there.
  void add(NodeClass node_class);
  /// @throws ConfigurationError with "did you mean".
  const NodeClass& find(std::string_view name) const;
  bool contains(std::string_view name) const;
  std::vector<std::string> names() const;  ///< sorted

  /// Adds the node classes of the plug-ins that were linked into this program, compiled with
  /// SPIKELOOP_STATIC_PLUGIN; returns their names.
  /// @throws ConfigurationError when a class of one of these names is already there.
  std::vector<std::string> add_linked_plugins();

  /// Loads a shared library, or a *.py file, and adds its node classes; returns their names. Size,
  /// ABI version and build of a library are checked before anything in it is called. Of a file that
  /// is not a library the classes are made by a library of ours, which is looked for in
  /// SPIKELOOP_LIBRARY_PATH, beside the program, and in ../lib/spikeloop of it. A path without '/'
  /// is seen from the working directory, like any other.
  /// @throws ConfigurationError with the path and the reason: cannot be loaded, is not a plug-in,
  /// was built for another version, names a class that is already there, malformed description.
  std::vector<std::string> load_plugin(const std::string& path);
  /// Loads every *.so in the directories of a ':'-separated list (SPIKELOOP_PLUGIN_PATH), and every
  /// *.py that defines nodes: one with a line that begins with @spikeloop.node or another @...node.
  std::vector<std::string> load_plugin_path(std::string_view directories);

 private:
  /// All classes of a plug-in, or none.
  std::vector<std::string> add_classes(const std::string& path, const spikeloop_plugin& plugin);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop
