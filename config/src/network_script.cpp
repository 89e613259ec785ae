#include "spikeloop/config/network_script.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "spikeloop/config/files_read.hpp"
#include "spikeloop/config/reason.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "text_file.hpp"

namespace spikeloop {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSuffix = ".py";
constexpr std::uint64_t kMostBytes = 1'000'000'000;

// A folder that is gone with the object.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "spikeloop-network-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw FileError("make a folder", name, errno);
    }
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path file(const char* name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// The package `spikeloop`: beside the programs, as installed and in the build tree, or in the
// sources.
std::string package() {
  std::error_code ignored;
  const fs::path programs = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const fs::path installed = programs.parent_path() / "share/spikeloop/python";
  return fs::exists(installed / "spikeloop") ? installed.string() : SPIKELOOP_PYTHON;
}

std::vector<std::string> environment() {
  std::vector<std::string> variables;
  std::string path = package();
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string variable = *entry;
    constexpr std::string_view kPath = "PYTHONPATH=";
    if (!variable.starts_with(kPath)) {
      variables.push_back(variable);
    } else if (variable.size() > kPath.size()) {
      path = variable.substr(kPath.size()) + ":" + path;  // what the user has put there goes first
    }
  }
  variables.push_back("PYTHONPATH=" + path);
  return variables;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> list;
  for (std::string& word : words) {
    list.push_back(word.data());
  }
  list.push_back(nullptr);
  return list;
}

// Its exit code; 128 + the signal that ended it. What it prints goes to the error stream.
int run_python(std::vector<std::string> words) {
  std::vector<std::string> variables = environment();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  pid_t child = 0;
  const int failure = ::posix_spawnp(&child, words[0].c_str(), &actions, nullptr,
                                     pointers(words).data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    throw FileError("start", words[0], failure);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string python() {
  const char* const named = std::getenv("PYTHON");
  return named == nullptr || *named == '\0' ? "/usr/bin/python3" : named;
}

// What Python says of its own fault: the line in the file, 0 for none, and the text.
[[noreturn]] void refuse(const std::string& file, const std::string& function, const Folder& folder,
                         int exit_code) {
  const fs::path fault = folder.file("fault");
  if (!fs::exists(fault)) {
    throw ConfigurationError(
        {file, 0, 0}, fmt::format("Python ended with exit code {} before the function '{}' was "
                                  "over; what it said stands above",
                                  exit_code, function));
  }
  const FilesRead unnoted;
  std::istringstream told(read_text_file(fault.string(), kMostBytes, "fault"));
  int line = 0;
  std::string text;
  told >> line >> std::ws;
  std::getline(told, text, '\0');
  throw ConfigurationError({file, line, line > 0 ? 1 : 0}, text);
}

// The line of the user's file behind each line of the network file that Python wrote.
Location behind(const Location& where, const std::string& file, const Folder& folder) {
  std::istringstream lines(
      read_text_file(folder.file("lines").string(), kMostBytes, "lines of the network file"));
  int line = 0;
  for (int i = 0; i < where.line && lines >> line; ++i) {
  }
  return {file, line, line > 0 ? 1 : 0};
}

// Places in the file that Python wrote would tell nobody anything.
void set_places(NetworkFile& network, const Location& where) {
  network.resolution_where = where;
  for (auto& population : network.populations) {
    population.where = where;
  }
  for (auto& projection : network.projections) {
    projection.where = where;
  }
  for (auto& record : network.record) {
    record.where = where;
  }
}

NetworkFile read_result(const std::string& file, const Folder& folder) {
  const std::string text =
      read_text_file(folder.file("network.json").string(), kMostBytes, "network file");
  try {
    NetworkFile network = parse_network(text, file, [](const std::string& weights) {
      return read_weights(weights, {.short_forms = false});
    });
    set_places(network, {file, 0, 0});
    return network;
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(behind(error.where(), file, folder), reason_of(error));
  }
}

}  // namespace

std::string network_source(const std::string& written) {
  const auto colon = written.rfind(':');
  const bool named = colon != std::string::npos && written.find('/', colon) == std::string::npos &&
                     std::string_view(written).substr(0, colon).ends_with(kSuffix);
  return named ? written.substr(0, colon) : written;
}

bool is_network_script(const std::string& written) {
  return network_source(written).ends_with(kSuffix);
}

NetworkFile run_network_script(const std::string& written) {
  const std::string file = network_source(written);
  const std::string function =
      file.size() == written.size() ? "make" : written.substr(file.size() + 1);
  if (!fs::exists(file)) {
    throw FileError("read the network's function from", file, ENOENT);
  }
  const Folder folder;
  const int exit_code =
      run_python({python(), "-m", "spikeloop.network", file, function, folder.path().string()});
  if (exit_code != 0) {
    refuse(file, function, folder, exit_code);
  }
  std::set<std::string> files{file};
  NetworkFile network;
  {
    const FilesRead read;
    network = read_result(file, folder);
    files.insert(read.paths().begin(), read.paths().end());
  }
  for (const std::string& path : files) {
    if (!path.starts_with(folder.path().string())) {
      FilesRead::note(path);
    }
  }
  return network;
}

}  // namespace spikeloop
