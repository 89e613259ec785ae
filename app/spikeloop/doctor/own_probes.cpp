// Spikeloop itself: its programs, the libraries that they load, its files, its plug-ins.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "../output.hpp"
#include "../own_programs.hpp"
#include "probe.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/nodes/register.hpp"
#include "spikeloop/processes/python.hpp"

namespace spikeloop::app::doctor {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInstallAgain = "build and install Spikeloop again: all of it, scripts/build";

fs::path own_file(std::string_view name) {
  return fs::path(own_directory()) / name;
}

bool is_there(std::string_view program) {
  return !launch::find_executable(own_file(program), "", "").empty();
}

Finding programs() {
  std::vector<std::string> names = all_programs();
  const std::size_t count = names.size();
  std::erase_if(names, is_there);
  return names.empty()
             ? ok(fmt::format("{} in {}", count, own_directory()))
             : missing(fmt::format("not in {}: {}", own_directory(), fmt::join(names, ", ")),
                       kInstallAgain);
}

Finding judge_libraries(const Answer& answer) {
  std::vector<std::string> absent;
  const auto libraries = libraries_in(answer.out);
  for (const auto& [name, file] : libraries) {
    if (file == "not found") {
      absent.push_back(name);
    }
  }
  return absent.empty() ? ok(fmt::format("{} shared libraries of its programs", libraries.size()))
                        : missing(fmt::format("not found: {}", fmt::join(absent, ", ")));
}

Finding worlds() {
  const fs::path directory = own_file("../share/spikeloop/worlds").lexically_normal();
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(directory, ignored)) {
    names.push_back(entry.path().filename());
  }
  std::ranges::sort(names);
  return std::ranges::count(names, "arena.xml") == 0
             ? missing(fmt::format("no arena.xml in {}", directory.string()), kInstallAgain)
             : ok(fmt::format("{} in {}", fmt::join(names, ", "), directory.string()));
}

/// Libraries and Python files alike.
Finding look_at_plugin(const std::string& path) {
  Registry registry;
  register_nodes(registry);
  try {
    const std::vector<std::string> classes = registry.load_plugin(path);
    return {.text = fmt::format("node={}", fmt::join(classes, " ")), .classes = classes};
  } catch (const Error& error) {
    const std::string text = error.what();
    const std::string prefix = fmt::format("plug-in '{}': ", path);  // which is the probe's name
    return missing(text.starts_with(prefix) ? text.substr(prefix.size()) : text);
  }
}

Probe plugin_probe(const std::string& path) {
  const char* const cure = path.ends_with(".so")
                               ? "rebuild it with this Spikeloop (docs/plugins.md)"
                               : "correct it (docs/python-nodes.md)";
  return apart(path, true,
               missing("cannot be loaded: ",
                       fmt::format("{}, or take it out of SPIKELOOP_PLUGIN_PATH", cure)),
               [path] { return look_at_plugin(path); });
}

}  // namespace

Command linker_list(const std::vector<std::string>& programs) {
  // With this variable the dynamic linker prints what a program would load, and does not start it.
  Command command{"/bin/sh", "-c", "for program; do LD_TRACE_LOADED_OBJECTS=1 \"$program\"; done",
                  "sh"};
  std::ranges::transform(programs, std::back_inserter(command), own_file);
  return command;
}

std::set<std::pair<std::string, std::string>> libraries_in(const std::string& linker_list) {
  std::set<std::pair<std::string, std::string>> libraries;
  std::istringstream lines(linker_list);
  for (std::string line; std::getline(lines, line);) {  // "\tlibm.so.6 => /lib/libm.so.6 (0x7f00)"
    const auto arrow = line.find(" => ");
    if (arrow != std::string::npos) {
      const auto file = arrow + 4;
      libraries.emplace(line.substr(1, arrow - 1), line.substr(file, line.rfind(" (") - file));
    }
  }
  return libraries;
}

std::vector<Probe> own_probes() {
  std::vector<std::string> files(kProgramFiles.begin(), kProgramFiles.end());
  std::erase_if(files, std::not_fn(is_there));
  return {{"Spikeloop", true,
           ok(fmt::format("{}, {}, gcc {}, {}", SPIKELOOP_VERSION, SPIKELOOP_BUILD_TYPE,
                          __VERSION__, SPIKELOOP_BUILD))},
          {"its programs", true, programs()},
          {"its libraries", true,
           missing("", "scripts/install-dependencies, then build Spikeloop again"),
           linker_list(files), judge_libraries},
          {"worlds", false, worlds()}};
}

std::vector<Probe> plugin_probes() {
  std::vector<Probe> probes;
  for (const std::string& directory : path_list(plugin_path())) {
    try {
      std::error_code error;
      const std::vector<std::string> paths = plugin_files(directory, error);
      if (error) {
        throw FileError("read", directory, error.value());
      }
      probes.push_back({directory, true, ok(count_of(paths.size(), "plug-in"))});
      std::ranges::transform(paths, std::back_inserter(probes), plugin_probe);
    } catch (const Error& error) {
      probes.push_back(
          {directory, true,
           missing(error.what(), "correct that, or take it out of SPIKELOOP_PLUGIN_PATH")});
    }
  }
  if (probes.empty()) {
    probes.push_back({"plug-ins", false, ok("SPIKELOOP_PLUGIN_PATH is not set")});
  }
  return probes;
}

}  // namespace spikeloop::app::doctor
