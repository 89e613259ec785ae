#include "spikeloop/config/script_file.hpp"

#include <fstream>
#include <regex>

namespace spikeloop {

ScriptHost host_in_script(const std::string& path) {
  static const std::regex import(R"(\s*(from\s+spikeloop[\s.]|import\s+(.*[\s,])?spikeloop\b).*)");
  static const std::regex nest(
      R"(\s*(from\s+spikeloop(\.nest\s|\s+import\s+(.*[\s,])?nest\b)|import\s+(.*[\s,])?spikeloop\.nest\b).*)");
  constexpr std::size_t kLongest = 200;  // of a line that imports; std::regex recurses
  ScriptHost found = ScriptHost::none;
  std::ifstream script(path);
  for (std::string line; std::getline(script, line);) {
    if (line.size() < kLongest && line.find("spikeloop") != std::string::npos &&
        std::regex_match(line, import)) {
      if (std::regex_match(line, nest)) {
        return ScriptHost::nest;
      }
      found = ScriptHost::other;
    }
  }
  return found;
}

}  // namespace spikeloop
