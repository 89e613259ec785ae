#include "shared_library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <utility>

#include "plugin_text.hpp"

namespace spikeloop {

SharedLibrary::SharedLibrary(std::string path, bool stays) : path_(std::move(path)) {
  // Without a '/' the dynamic linker would look in its own places alone.
  const std::string file = path_.find('/') == std::string::npos ? "./" + path_ : path_;
  handle_ = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | (stays ? RTLD_NODELETE : 0));
  if (handle_ == nullptr) {
    refuse(path_, fmt::format("cannot be loaded: {}", text_or_empty(dlerror())));
  }
}

SharedLibrary::SharedLibrary(SharedLibrary&& other) noexcept
    : path_(std::move(other.path_)), handle_(std::exchange(other.handle_, nullptr)) {}

SharedLibrary& SharedLibrary::operator=(SharedLibrary&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(handle_, other.handle_);
  return *this;
}

SharedLibrary::~SharedLibrary() {
  if (handle_ != nullptr) {
    dlclose(handle_);
  }
}

void* SharedLibrary::symbol(const char* name, const char* remedy) const {
  void* found = dlsym(handle_, name);
  if (found == nullptr) {
    refuse(path_, fmt::format("is not a Spikeloop plug-in (it has no {}); {}", name, remedy));
  }
  return found;
}

template <typename Entry>
const Entry& SharedLibrary::checked_entry(const char* name, const char* remedy) const {
  const Entry* entry = reinterpret_cast<const Entry* (*)()>(symbol(name, remedy))();
  if (entry == nullptr) {
    refuse(path_, "its entry function returned nothing");
  }
  if (entry->abi_version != SPIKELOOP_ABI_VERSION) {
    refuse(path_, fmt::format("was built for plug-in ABI {}, this Spikeloop has {}; rebuild it",
                              entry->abi_version, SPIKELOOP_ABI_VERSION));
  }
  if (entry->size < sizeof(Entry)) {
    refuse(path_,
           fmt::format("its entry structure has {} bytes, this Spikeloop needs {}; rebuild it",
                       entry->size, sizeof(Entry)));
  }
  if (text_or_empty(entry->build) != SPIKELOOP_BUILD) {
    refuse(path_, fmt::format("was built for '{}', this machine is '{}'; rebuild it",
                              text_or_empty(entry->build), SPIKELOOP_BUILD));
  }
  return *entry;
}

const spikeloop_plugin& SharedLibrary::checked_plugin() const {
  return checked_entry<spikeloop_plugin>("spikeloop_plugin_entry",
                                         "write SPIKELOOP_PLUGIN(...) in one of its sources");
}

const spikeloop_loader& SharedLibrary::checked_loader() const {
  return checked_entry<spikeloop_loader>("spikeloop_loader_entry", "install it again");
}

}  // namespace spikeloop
