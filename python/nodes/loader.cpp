// The library's entry: *.py files as plug-ins.
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>

#include "python_class.hpp"

namespace spikeloop::python {

namespace py = pybind11;

namespace {

/// Read as text: files that are no nodes must not run because they lie in the same directory.
int defines_nodes(const char* path) {
  static const std::regex decorator(R"(\s*@\s*(\w+\.)*node\b.*)");
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.find('@') < 200 && std::regex_match(line.substr(0, 200), decorator)) {
      return 1;
    }
  }
  return 0;
}

/// Every file is run once, as Python's import does.
const spikeloop_plugin* file_at(const std::string& path, const spikeloop_host& host) {
  static auto* const files = new std::map<std::string, PythonFile>;  // never deleted: see plugin.h
  std::error_code error;
  const std::string key = std::filesystem::weakly_canonical(path, error).string();
  auto found = files->find(key);
  if (found == files->end()) {
    PythonFile file(path, host);
    found = files->emplace(key, std::move(file)).first;
  }
  return found->second.plain();
}

const spikeloop_plugin* load(const char* path, const spikeloop_host* host, char* error,
                             std::uint64_t error_size) {
  try {
    start_package();
    const Lock lock;
    try {
      return file_at(path, *host);
    } catch (const py::error_already_set& raised) {
      write_error(described(raised, *host, SPIKELOOP_LOG_INFO), error, error_size);
    }
  } catch (const std::exception& exception) {
    write_error(std::string("plug-in '") + path + "': " + exception.what(), error, error_size);
  }
  return nullptr;
}

}  // namespace
}  // namespace spikeloop::python

extern "C" __attribute__((visibility("default"))) const spikeloop_loader* spikeloop_loader_entry(
    void) {
  static const spikeloop_loader kLoader = {sizeof(spikeloop_loader), SPIKELOOP_ABI_VERSION,
                                           SPIKELOOP_BUILD, &spikeloop::python::defines_nodes,
                                           &spikeloop::python::load};
  return &kLoader;
}
