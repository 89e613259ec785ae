// Finds the function that one of ours, preloaded under its name, stands before.
#pragma once

#include <dlfcn.h>

namespace spikeloop {

/// The next `name` in the order of the dynamic linker, else that of the caller's library: Python
/// opens MUSIC and MPI for a module alone, where RTLD_NEXT does not look. Null: there is none.
inline void* next_function(const char* name, const void* caller) {
  if (void* const next = dlsym(RTLD_NEXT, name)) {
    return next;
  }
  Dl_info info{};
  const bool known = dladdr(caller, &info) != 0;
  void* const library = known ? dlopen(info.dli_fname, RTLD_LAZY | RTLD_NOLOAD) : nullptr;
  return library == nullptr ? nullptr : dlsym(library, name);
}

}  // namespace spikeloop
