#include "plugin_loader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "shared_library.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/core/python_library.hpp"

namespace spikeloop {

namespace {

namespace fs = std::filesystem;

struct Loader {
  const char* extension;
  const char* library;
};

constexpr Loader kLoaders[] = {{".py", "libspikeloop_python_nodes.so"}};

const Loader* loader_of(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  for (const Loader& loader : kLoaders) {
    if (extension == loader.extension) {
      return &loader;
    }
  }
  return nullptr;
}

/// Beside the program, in the build tree as installed; SPIKELOOP_LIBRARY_PATH goes first.
std::vector<std::string> directories() {
  const char* const written = std::getenv("SPIKELOOP_LIBRARY_PATH");
  std::vector<std::string> all = path_list(written == nullptr ? "" : written);
  std::error_code error;
  const fs::path programs = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (!error) {
    all.push_back(programs.string());
    all.push_back((programs.parent_path() / "lib" / "spikeloop").string());
  }
  return all;
}

SharedLibrary open_library(const Loader& loader, const std::string& for_what) {
  const auto searched = directories();
  for (const std::string& directory : searched) {
    const fs::path library = fs::path(directory) / loader.library;
    std::error_code error;
    if (fs::exists(library, error)) {
      // What it gives outlives the handle: the library stays.
      return SharedLibrary(library.string(), true);
    }
  }
  throw ConfigurationError(
      with_code(Code::plug_in,
                "{} need {}, which is not in {}; install Spikeloop with it, or write its directory "
                "into SPIKELOOP_LIBRARY_PATH",
                for_what, loader.library, fmt::join(searched, ", ")));
}

const spikeloop_loader& open_loader(const Loader& loader, const std::string& path) {
  return open_library(loader, fmt::format("plug-in '{}': *{} files", path, loader.extension))
      .checked_loader();
}

void log_line(std::uint32_t level, const char* line) {
  log::write(level == SPIKELOOP_LOG_WARNING ? log::Level::warning : log::Level::info, line);
}

constexpr spikeloop_host kHost{&log_line};

}  // namespace

bool has_loader(const std::string& path) {
  return loader_of(path) != nullptr;
}

bool defines_nodes(const std::string& path) {
  return open_loader(*loader_of(path), path).defines_nodes(path.c_str()) != 0;
}

const spikeloop_plugin& load_by_loader(const std::string& path) {
  const spikeloop_loader& loader = open_loader(*loader_of(path), path);
  std::array<char, 2048> message{};
  const spikeloop_plugin* plugin =
      loader.load(path.c_str(), &kHost, message.data(), message.size());
  if (plugin == nullptr) {
    message.back() = '\0';
    throw ConfigurationError(with_code(Code::plug_in, message.data()));
  }
  return *plugin;
}

void* python_function(const char* name, const std::string& for_what) {
  const SharedLibrary library = open_library(kLoaders[0], for_what + ": environments in Python");
  library.checked_loader();
  return library.symbol(name, "install it again");
}

const spikeloop_host& python_host() {
  return kHost;
}

std::vector<std::string> plugin_files(const std::string& directory, std::error_code& error) {
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    const std::string path = entry.path().string();
    if (entry.path().extension() == ".so" || (has_loader(path) && defines_nodes(path))) {
      paths.push_back(path);
    }
  }
  std::ranges::sort(paths);
  return paths;
}

}  // namespace spikeloop
