#include "descendants.hpp"

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>

namespace spikeloop::launch {
namespace {

/// Reads "PID (NAME) STATE PARENT ..."; NAME may hold blanks and brackets.
bool read_parent(const std::filesystem::path& process, char& state, pid_t& parent) {
  std::ifstream file(process / "stat");
  std::string text;
  std::getline(file, text);
  const auto end_of_name = text.rfind(')');
  if (end_of_name == std::string::npos || end_of_name + 4 >= text.size()) {
    return false;
  }
  state = text[end_of_name + 2];
  parent = static_cast<pid_t>(std::strtol(text.c_str() + end_of_name + 4, nullptr, 10));
  return true;
}

}  // namespace

std::vector<pid_t> descendants(pid_t ancestor) {
  std::multimap<pid_t, pid_t> children;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    char state = 'Z';
    pid_t parent = 0;
    if (std::isdigit(static_cast<unsigned char>(name.front())) != 0 &&
        read_parent(entry.path(), state, parent) && state != 'Z' && state != 'X') {
      children.emplace(parent, static_cast<pid_t>(std::stol(name)));
    }
  }
  std::vector<pid_t> found{ancestor};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto [begin, end] = children.equal_range(found[i]);
    for (auto child = begin; child != end; ++child) {
      found.push_back(child->second);
    }
  }
  found.erase(found.begin());
  return found;
}

std::map<std::string, bool> living_sections(pid_t ancestor) {
  constexpr std::string_view kVariable = "_MUSIC_CONFIG_=";
  std::map<std::string, bool> stopped;
  for (const pid_t pid : descendants(ancestor)) {
    const std::filesystem::path process = "/proc/" + std::to_string(pid);
    std::ifstream environment(process / "environ", std::ios::binary);
    for (std::string entry; std::getline(environment, entry, '\0');) {
      if (entry.starts_with(kVariable)) {
        entry.erase(0, kVariable.size());
        char state = 'Z';
        pid_t parent = 0;
        read_parent(process, state, parent);
        stopped[entry.substr(0, entry.find(':'))] |= state == 'T';
      }
    }
  }
  return stopped;
}

}  // namespace spikeloop::launch
