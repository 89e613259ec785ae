// Libraries that few runs need, opened when one is asked for.
#pragma once

#include <string>

namespace spikeloop {

class OpenLibrary {
 public:
  /// Where its own symbols are looked up: among the program's first, or not.
  enum class Symbols { shared, own_first };

  /// It stays open: drivers have threads.
  /// @param purpose what cannot be done without it, "draw without a display"
  /// @param remedy "install it:  apt-get install libegl1"
  /// @throws TransportError that ends with the remedy.
  OpenLibrary(const char* file, const char* purpose, const char* remedy,
              Symbols symbols = Symbols::shared);

  /// @throws TransportError when the library has no such function.
  template <typename Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(symbol(name));
  }

 private:
  void* symbol(const char* name) const;

  const char* file_;
  const char* remedy_;
  void* handle_;
};

}  // namespace spikeloop
