#include "spikeloop/processes/descendants.hpp"

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>

namespace spikeloop {
namespace {

/// What man 5 proc says of "PID (NAME) STATE PARENT ..."; NAME may hold blanks and brackets.
struct Stat {
  char state = 'X';
  pid_t parent = 0;
  int exit_status = -1;

  bool ended() const { return state == 'Z' || state == 'X'; }
};

/// Nothing for a process that has been waited for.
std::optional<Stat> read_stat(const std::string& pid) {
  std::ifstream file("/proc/" + pid + "/stat");
  std::string text;
  std::getline(file, text);
  const auto end_of_name = text.rfind(')');
  if (end_of_name == std::string::npos) {
    return std::nullopt;
  }
  std::istringstream fields(text.substr(end_of_name + 1));
  Stat stat;
  fields >> stat.state >> stat.parent;
  std::string skipped;
  for (int field = 5; field < 52; ++field) {
    fields >> skipped;
  }
  if (!(fields >> stat.exit_status)) {
    stat.exit_status = -1;
  }
  return stat;
}

}  // namespace

std::vector<pid_t> descendants(pid_t ancestor) {
  std::multimap<pid_t, pid_t> children;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    if (std::isdigit(static_cast<unsigned char>(name.front())) == 0) {
      continue;
    }
    const auto stat = read_stat(name);
    if (stat && !stat->ended()) {
      children.emplace(stat->parent, static_cast<pid_t>(std::stol(name)));
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
  const auto stat = read_stat(std::to_string(process));
  return stat && stat->state == 'T';
}

bool is_sleeping(pid_t process) {
  const auto stat = read_stat(std::to_string(process));
  return stat && stat->state == 'S';
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
  const auto stat = read_stat(std::to_string(process));
  if (!stat) {
    return -1;
  }
  return stat->ended() ? std::optional(stat->exit_status) : std::nullopt;
}

}  // namespace spikeloop
