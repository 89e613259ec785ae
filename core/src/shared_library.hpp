// Libraries that are opened while the program runs: plug-ins, and loaders of files that are none.
#pragma once

#include <string>

#include "spikeloop/core/plugin.h"

namespace spikeloop {

/// An open shared library; closed when destroyed.
class SharedLibrary {
 public:
  /// One that `stays` is never closed: it may have threads, or memory that others point to.
  /// @throws ConfigurationError when it cannot be loaded.
  explicit SharedLibrary(std::string path, bool stays = false);
  SharedLibrary(SharedLibrary&& other) noexcept;
  SharedLibrary& operator=(SharedLibrary&& other) noexcept;
  SharedLibrary(const SharedLibrary&) = delete;
  SharedLibrary& operator=(const SharedLibrary&) = delete;
  ~SharedLibrary();

  /// The plug-in's entry structure after size, ABI version and build have been checked.
  /// @throws ConfigurationError that says what is wrong and to rebuild.
  const spikeloop_plugin& checked_plugin() const;
  /// The same of a loader.
  const spikeloop_loader& checked_loader() const;
  /// @throws ConfigurationError, which ends with the remedy, when it has none of this name.
  void* symbol(const char* name, const char* remedy) const;

 private:
  template <typename Entry>
  const Entry& checked_entry(const char* name, const char* remedy) const;

  std::string path_;
  void* handle_ = nullptr;
};

}  // namespace spikeloop
