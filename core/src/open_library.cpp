#include "spikeloop/core/open_library.hpp"
#include "spikeloop/core/code.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

OpenLibrary::OpenLibrary(const char* file, const char* purpose, const char* remedy, Symbols symbols)
    : file_(file),
      remedy_(remedy),
      handle_(::dlopen(file, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE |
                                 (symbols == Symbols::own_first ? RTLD_DEEPBIND : 0))) {
  if (handle_ == nullptr) {
    throw TransportError(
        with_code(Code::plug_in, "cannot {}: {}; {}", purpose, ::dlerror(), remedy));
  }
}

void* OpenLibrary::symbol(const char* name) const {
  void* found = ::dlsym(handle_, name);
  if (found == nullptr) {
    throw TransportError(with_code(Code::plug_in, "{} has no {}, it is of another version; {}",
                                   file_, name, remedy_));
  }
  return found;
}

}  // namespace spikeloop
