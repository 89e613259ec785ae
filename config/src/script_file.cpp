#include "spikeloop/config/script_file.hpp"

#include <cerrno>
#include <fstream>
#include <regex>
#include <string_view>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop {
namespace {

/// As Python reads it: without a byte order mark, and a line may end as those of Windows do.
void strip(std::string& line, bool first) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (first && line.starts_with(kMark)) {
    line.erase(0, kMark.size());
  }
  if (line.ends_with('\r')) {
    line.pop_back();
  }
}

}  // namespace

ScriptHost host_in_script(const std::string& path) {
  static const std::regex import(R"(\s*(from\s+spikeloop[\s.]|import\s+(.*[\s,])?spikeloop\b).*)");
  static const std::regex nest(
      R"(\s*(from\s+spikeloop(\.nest\s|\s+import\s+(.*[\s,])?nest\b)|import\s+(.*[\s,])?spikeloop\.nest\b).*)");
  constexpr std::size_t kLongest = 200;  // of a line that imports; std::regex recurses
  ScriptHost found = ScriptHost::none;
  require_regular_file(path, "script");
  errno = 0;
  std::ifstream script(path);
  bool first = true;
  for (std::string line; std::getline(script, line); first = false) {
    strip(line, first);
    if (line.size() < kLongest && line.find("spikeloop") != std::string::npos &&
        std::regex_match(line, import)) {
      if (std::regex_match(line, nest)) {
        return ScriptHost::nest;
      }
      found = ScriptHost::other;
    }
  }
  if (!script.is_open() || script.bad()) {
    throw FileError("read", path, errno);
  }
  return found;
}

}  // namespace spikeloop
