#include "descendants.hpp"

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
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

bool is_stopped(pid_t process) {
  char state = 'Z';
  pid_t parent = 0;
  read_parent("/proc/" + std::to_string(process), state, parent);
  return state == 'T';
}

std::map<std::string, bool> living_sections(pid_t ancestor) {
  constexpr std::string_view kVariable = "_MUSIC_CONFIG_=";
  std::map<std::string, bool> stopped;
  for (const pid_t pid : descendants(ancestor)) {
    std::ifstream environment("/proc/" + std::to_string(pid) + "/environ", std::ios::binary);
    for (std::string entry; std::getline(environment, entry, '\0');) {
      if (entry.starts_with(kVariable)) {
        entry.erase(0, kVariable.size());
        stopped[entry.substr(0, entry.find(':'))] |= is_stopped(pid);
      }
    }
  }
  return stopped;
}

std::optional<int> end_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  const auto end_of_name = text.rfind(')');
  if (end_of_name == std::string::npos) {
    return -1;
  }
  // man 5 proc: the state is field 3, the exit code field 52.
  std::istringstream fields(text.substr(end_of_name + 1));
  std::string state;
  fields >> state;
  if (state != "Z" && state != "X") {
    return std::nullopt;
  }
  std::string skipped;
  for (int field = 4; field < 52; ++field) {
    fields >> skipped;
  }
  int status = -1;
  return fields >> status ? status : -1;
}

}  // namespace spikeloop::launch
