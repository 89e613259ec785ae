#include "python_package.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "doctor/probe.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/processes/python.hpp"

namespace spikeloop::app {

std::string python_program() {
  const std::string name = python_name();
  return name.find('/') == std::string::npos ? doctor::in_path(name)
                                             : launch::find_executable(name, ".", "");
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
  ::setenv("PYTHONPATH", python_path().c_str(), 1);
  ::setenv("PYTHONSAFEPATH", "1", 1);  // no module of the working directory's
  ::setenv("MPLBACKEND", "Agg", 1);
  std::vector<std::string> words{python, "-m", module};
  words.insert(words.end(), arguments.begin(), arguments.end());
  throw FileError("start", python, become_program(words));
}

}  // namespace spikeloop::app
