#include "spikeloop/launch/hostfile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::launch {
namespace {

constexpr const char* kExample = "write a line like  robot slots=4";

/// NAME, ADDRESS or USER@HOST; ADDRESS may be one of IPv6.
bool is_host(std::string_view word) {
  const std::string_view host = word.substr(word.find('@') + 1);
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  const bool relative = host.starts_with('+');
  const bool six = std::ranges::count(host, ':') > 1;
  return !host.empty() && host.front() != '-' && !word.starts_with('@') &&
         (relative || host.find_first_not_of(std::string(kLetters) + (six ? ":" : "")) ==
                          std::string_view::npos);
}

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos;
}

/// As in Open MPI's hostfile_lex.l.
bool is_option(std::string_view word) {
  constexpr std::array kCounts{"slots",     "slots_max", "slots-max", "max_slots",
                               "max-slots", "cpu",       "cpu_max",   "cpu-max",
                               "max_cpu",   "max-cpu",   "count",     "count_max",
                               "count-max", "max_count", "max-count", "port"};
  constexpr std::array kNames{"username", "user-name", "user_name"};
  const auto equals = word.find('=');
  if (equals == std::string_view::npos || equals + 1 == word.size()) {
    return is_number(word);
  }
  const std::string_view name = word.substr(0, equals);
  return std::ranges::find(kNames, name) != kNames.end() ||
         (is_number(word.substr(equals + 1)) && std::ranges::find(kCounts, name) != kCounts.end());
}

/// Without comments and without blanks around '='. `inside`: of a comment of several lines.
std::string plain_line(std::string line, bool& inside) {
  for (std::size_t begin = inside ? 0 : line.find("/*"); begin != std::string::npos;
       begin = line.find("/*")) {
    const std::size_t end = line.find("*/", begin);
    inside = end == std::string::npos;
    line.erase(begin, inside ? std::string::npos : end + 2 - begin);
  }
  line.erase(std::min({line.find('#'), line.find("//"), line.size()}));
  for (std::size_t i = line.find('='); i != std::string::npos; i = line.find('=', i + 1)) {
    while (i + 1 < line.size() && line[i + 1] == ' ') {
      line.erase(i + 1, 1);
    }
    while (i > 0 && line[i - 1] == ' ') {
      line.erase(--i, 1);
    }
  }
  return line;
}

/// Returns the host that the line names; empty: none.
std::string check_line(const std::string& line, const Location& where) {
  if (line.ends_with('\r')) {
    throw ConfigurationError(
        where, with_code(Code::syntax, "the line ends as on Windows; write  sed -i 's/\\r$//' {}",
                         where.file));
  }
  std::istringstream words(line);
  std::string host;
  if (words >> host && !is_host(host)) {
    throw ConfigurationError(
        where, with_code(Code::invalid_name, "'{}' is not a valid host name; {}", host, kExample));
  }
  for (std::string word; words >> word;) {
    if (!is_option(word)) {
      throw ConfigurationError(
          where, with_code(Code::unknown_key, "'{}' is none of Open MPI's options of a host; {}",
                           word, kExample));
    }
  }
  return host;
}

}  // namespace

void check_hostfile(const std::string& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw FileError(
        with_code(Code::no_access, "cannot read the hostfile '{}': not a regular file", path));
  }
  std::ifstream file(path);
  if (!file) {
    throw FileError("open the hostfile", path, errno == 0 ? ENOENT : errno);
  }
  std::map<std::string, int> lines;  // a batch system may list a host once for each slot
  std::set<std::string> counted;
  Location where{path};
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    ++where.line;
    const std::string host = check_line(plain_line(line, inside), where);
    if (host.empty()) {
      continue;
    }
    const bool has_slots = line.find("slots") != std::string::npos;
    const auto [first, is_new] = lines.emplace(host, where.line);
    if (!is_new && (has_slots || counted.contains(host))) {
      throw ConfigurationError(where, with_code(Code::duplicate_name,
                                                "the host '{}' stands in line {} already; write "
                                                "it once, with all its slots",
                                                host, first->second));
    }
    if (has_slots) {
      counted.insert(host);
    }
  }
  if (lines.empty()) {
    throw ConfigurationError(
        Location{path}, with_code(Code::missing_key, "the hostfile names no host; {}", kExample));
  }
}

}  // namespace spikeloop::launch
