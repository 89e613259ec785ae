// The host's side of the plain-data border: classes that live in a shared library.
#pragma once

#include <string>

#include "spikeloop/core/node.hpp"
#include "spikeloop/core/plugin.h"

namespace spikeloop {

/// An open shared library; closed when destroyed.
class SharedLibrary {
 public:
  /// @throws ConfigurationError when it cannot be loaded.
  explicit SharedLibrary(std::string path);
  SharedLibrary(SharedLibrary&& other) noexcept;
  SharedLibrary& operator=(SharedLibrary&& other) noexcept;
  SharedLibrary(const SharedLibrary&) = delete;
  SharedLibrary& operator=(const SharedLibrary&) = delete;
  ~SharedLibrary();

  /// The plug-in's entry structure after size, ABI version and build have been checked.
  /// @throws ConfigurationError that says what is wrong and to rebuild.
  const spikeloop_plugin& checked_plugin() const;

 private:
  std::string path_;
  void* handle_ = nullptr;
};

/// A node class whose functions are called across the border.
/// @throws ConfigurationError when the description is malformed (null names, bad indices).
NodeClass foreign_node_class(const std::string& path, const spikeloop_node_class* foreign);

}  // namespace spikeloop
