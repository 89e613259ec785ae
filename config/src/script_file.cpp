#include "spikeloop/config/script_file.hpp"

#include <fstream>
#include <regex>

namespace spikeloop {

bool imports_spikeloop(const std::string& path) {
  static const std::regex import(R"(\s*(from\s+spikeloop[\s.]|import\s+(.*[\s,])?spikeloop\b).*)");
  constexpr std::size_t kLongest = 200;  // of a line that imports; std::regex recurses
  std::ifstream script(path);
  for (std::string line; std::getline(script, line);) {
    if (line.size() < kLongest && line.find("spikeloop") != std::string::npos &&
        std::regex_match(line, import)) {
      return true;
    }
  }
  return false;
}

}  // namespace spikeloop
