#include "python_package.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "doctor/probe.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::app {

namespace fs = std::filesystem;

std::string python_name() {
  const char* const named = std::getenv("PYTHON");
  return named == nullptr || *named == '\0' ? "/usr/bin/python3" : named;
}

std::string python_program() {
  const std::string name = python_name();
  return name.find('/') == std::string::npos ? doctor::in_path(name)
                                             : launch::find_executable(name, ".", "");
}

std::string programs_folder() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path().string();
}

std::string python_package() {
  const fs::path installed = fs::path(programs_folder()).parent_path() / "share/spikeloop/python";
  return fs::exists(installed / "spikeloop") ? installed.string() : SPIKELOOP_PYTHON;
}

void become_python(const std::string& module, const std::vector<std::string>& arguments,
                   const std::string& purpose, const std::string& packages) {
  const std::string python = python_program();
  if (python.empty()) {
    throw TransportError(
        fmt::format("there is no python3, {}; apt-get install {}, or set PYTHON to one that has "
                    "them",
                    purpose, packages));
  }
  const char* const before = std::getenv("PYTHONPATH");
  const std::string path =
      python_package() + (before == nullptr || *before == '\0' ? "" : ":" + std::string(before));
  ::setenv("PYTHONPATH", path.c_str(), 1);
  ::setenv("PYTHONSAFEPATH", "1", 1);  // no module of the working directory's
  ::setenv("MPLBACKEND", "Agg", 1);
  std::vector<std::string> words{python, "-B", "-m", module};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  ::execv(python.c_str(), pointers.data());
  throw FileError("start", python, errno);
}

}  // namespace spikeloop::app
