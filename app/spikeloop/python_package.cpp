#include "python_package.hpp"

#include <cstdlib>
#include <filesystem>

#include "doctor/probe.hpp"
#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::app {

namespace fs = std::filesystem;

std::string python_program() {
  const char* const named = std::getenv("PYTHON");
  if (named == nullptr || *named == '\0') {
    return launch::find_executable("/usr/bin/python3", "", "");
  }
  const std::string name = named;
  return name.find('/') == std::string::npos ? doctor::in_path(name)
                                             : launch::find_executable(name, ".", "");
}

std::string python_package() {
  std::error_code ignored;
  const fs::path programs = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const fs::path installed = programs.parent_path() / "share/spikeloop/python";
  return fs::exists(installed / "spikeloop") ? installed.string() : SPIKELOOP_PYTHON;
}

}  // namespace spikeloop::app
