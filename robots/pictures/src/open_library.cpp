#include "open_library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include "spikeloop/core/error.hpp"

namespace spikeloop::pictures {

OpenLibrary::OpenLibrary(const char* file, const char* purpose, const char* packages)
    : file_(file), handle_(::dlopen(file, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)) {
  if (handle_ == nullptr) {
    throw TransportError(fmt::format("cannot {}: {}; install it:  apt-get install {}", purpose,
                                     ::dlerror(), packages));
  }
}

void* OpenLibrary::symbol(const char* name) const {
  void* found = ::dlsym(handle_, name);
  if (found == nullptr) {
    throw TransportError(fmt::format("{} has no {}; install a newer one", file_, name));
  }
  return found;
}

}  // namespace spikeloop::pictures
