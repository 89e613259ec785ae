#include "own_programs.hpp"

#include <set>

#include "spikeloop/launch/programs.hpp"

namespace spikeloop::app {

std::vector<std::string> all_programs() {
  std::set<std::string> names(kProgramFiles.begin(), kProgramFiles.end());
  for (const std::string_view name : launch::program_names()) {
    names.emplace(name);
  }
  return {names.begin(), names.end()};
}

}  // namespace spikeloop::app
