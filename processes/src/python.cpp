#include "spikeloop/processes/python.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

namespace spikeloop {

namespace fs = std::filesystem;

std::string own_directory() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path().string();
}

std::string python_name() {
  const char* const named = std::getenv("PYTHON");
  return named == nullptr || *named == '\0' ? "/usr/bin/python3" : named;
}

std::string python_package() {
  const fs::path installed = fs::path(own_directory()).parent_path() / "share/spikeloop/python";
  return fs::exists(installed / "spikeloop") ? installed.string() : SPIKELOOP_PYTHON;
}

std::string python_path() {
  const char* const written = std::getenv("PYTHONPATH");
  return (written == nullptr || *written == '\0' ? "" : written + std::string(":")) +
         python_package();
}

int become_program(std::vector<std::string> words) {
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  ::execvp(pointers.front(), pointers.data());
  return errno;
}

}  // namespace spikeloop
