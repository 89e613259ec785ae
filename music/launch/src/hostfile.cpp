#include "spikeloop/launch/hostfile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "spikeloop/core/error.hpp"

namespace spikeloop::launch {
namespace {

constexpr const char* kExample = "write a line like  robot slots=4";

/// A name, an address, or USER@HOST.
bool is_host(std::string_view word) {
  return word.find_first_not_of(
             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
             "._:-@") == std::string_view::npos;
}

bool is_option(std::string_view word) {
  constexpr std::array kCounts{"slots", "max_slots", "max-slots", "cpu", "count"};
  constexpr std::array kNames{"username", "user-name", "user_name"};
  const auto equals = word.find('=');
  if (equals == std::string_view::npos || equals + 1 == word.size()) {
    return false;
  }
  const std::string_view name = word.substr(0, equals);
  const bool number =
      word.substr(equals + 1).find_first_not_of("0123456789") == std::string_view::npos;
  return std::ranges::find(kNames, name) != kNames.end() ||
         (number && std::ranges::find(kCounts, name) != kCounts.end());
}

/// Returns whether the line names a host.
bool check_line(const std::string& line, const Location& where) {
  std::istringstream words(line.substr(0, line.find('#')));
  std::string host;
  if (!(words >> host)) {
    return false;
  }
  if (!is_host(host)) {
    throw ConfigurationError(where, fmt::format("'{}' is no name of a host; {}", host, kExample));
  }
  for (std::string word; words >> word;) {
    if (!is_option(word)) {
      throw ConfigurationError(
          where, fmt::format("'{}' is none of Open MPI's options of a host; {}", word, kExample));
    }
  }
  return true;
}

}  // namespace

void check_hostfile(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw FileError("read the hostfile", path, EISDIR);
  }
  std::ifstream file(path);
  if (!file) {
    throw FileError("open the hostfile", path, errno == 0 ? ENOENT : errno);
  }
  bool any = false;
  Location where{path};
  for (std::string line; std::getline(file, line);) {
    ++where.line;
    any = check_line(line, where) || any;
  }
  if (!any) {
    throw ConfigurationError(Location{path},
                             fmt::format("the hostfile names no host; {}", kExample));
  }
}

}  // namespace spikeloop::launch
