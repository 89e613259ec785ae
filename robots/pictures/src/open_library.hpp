// Libraries that only pictures need, opened when one is asked for.
#pragma once

#include <string>

namespace spikeloop::pictures {

class OpenLibrary {
 public:
  /// It stays open: drivers have threads.
  /// @param purpose what cannot be done without it, "draw without a display"
  /// @throws TransportError that names the packages to install.
  OpenLibrary(const char* file, const char* purpose, const char* packages);

  template <typename Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(symbol(name));
  }

 private:
  void* symbol(const char* name) const;
  const char* file_;
  void* handle_;
};

}  // namespace spikeloop::pictures
