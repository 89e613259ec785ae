// Spikeloop itself: its programs, the libraries that they load, its files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "../own_programs.hpp"
#include "probe.hpp"
#include "spikeloop/core/plugin.h"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::app::doctor {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInstallAgain = "build and install Spikeloop again: all of it, scripts/build";
constexpr const char* kInstallLibraries =
    "scripts/install-dependencies, then build Spikeloop again";

fs::path own_file(std::string_view name) {
  return fs::path(launch::own_directory()) / name;
}

Finding build() {
  return ok(fmt::format("{}, {}, gcc {}, {}", SPIKELOOP_VERSION, SPIKELOOP_BUILD_TYPE, __VERSION__,
                        SPIKELOOP_BUILD));
}

Finding programs() {
  std::vector<std::string> absent;
  const auto names = all_programs();
  std::ranges::copy_if(names, std::back_inserter(absent), [](const std::string& name) {
    return launch::find_executable(own_file(name), "", "").empty();
  });
  if (absent.empty()) {
    return ok(fmt::format("{} in {}", names.size(), launch::own_directory()));
  }
  return missing(fmt::format("not in {}: {}", launch::own_directory(), fmt::join(absent, ", ")),
                 kInstallAgain);
}

/// With this variable the dynamic linker prints what a program would load, and starts nothing.
launch::ProgramStart linker_list(std::string_view program) {
  return {{own_file(program)}, {{"LD_TRACE_LOADED_OBJECTS", "1"}}, "", ""};
}

std::vector<launch::ProgramStart> linker_lists() {
  std::vector<launch::ProgramStart> starts;
  std::ranges::transform(kProgramFiles, std::back_inserter(starts), linker_list);
  return starts;
}

/// Of lines such as "libmusic.so.1 => /lib/libmusic.so.1 (0x00007f)", the last part's first word.
std::string loaded_from(std::string_view list, std::string_view library) {
  const auto name = list.find(library);
  const auto arrow = name == std::string_view::npos ? name : list.find(" => ", name);
  if (arrow == std::string_view::npos) {
    return "";
  }
  const std::string_view place = first_line(list.substr(arrow + 4));
  return std::string(place.substr(0, place.find(" (")));
}

Finding libraries(const std::vector<Answer>& lists) {
  std::set<std::string> loaded;
  std::set<std::string> absent;
  for (const Answer& list : lists) {
    std::string_view rest = list.out;
    while (!rest.empty()) {
      const std::string_view line = first_line(rest);
      rest.remove_prefix(std::min(rest.size(), line.size() + 1));
      const auto begin = std::min(line.find_first_not_of(" \t"), line.size());
      const auto arrow = line.find(" => ");
      if (arrow != std::string_view::npos) {
        auto& names = line.ends_with("not found") ? absent : loaded;
        names.emplace(line.substr(begin, arrow - begin));
      }
    }
  }
  if (absent.empty()) {
    return ok(fmt::format("{} shared libraries of its programs", loaded.size()));
  }
  return missing(fmt::format("not found: {}", fmt::join(absent, ", ")), kInstallLibraries);
}

/// A library that stands for a part of Spikeloop, as one of its programs loads it.
struct Library {
  const char* name;
  bool needed;
  const char* program;
  const char* file;
  const char* package;
};

Finding judge_library(const Library& library, const Answer& list) {
  const std::string path = loaded_from(list.out, library.file);
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  if (path.empty() || error) {
    const std::string failure = list.failure();
    return missing(failure.empty()
                       ? fmt::format("no {}.so for {}", library.file, library.program)
                       : fmt::format("{} cannot be asked: {}", library.program, failure),
                   fmt::format("apt-get install {}", library.package));
  }
  return ok(real);
}

Probe library_probe(const Library& library) {
  return answer_of(library.name, library.needed, linker_list(library.program),
                   [library](const Answer& list) { return judge_library(library, list); });
}

Finding worlds() {
  const fs::path directory = own_file("../share/spikeloop/worlds").lexically_normal();
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(directory, ignored)) {
    names.push_back(entry.path().filename());
  }
  std::ranges::sort(names);
  if (std::ranges::find(names, "arena.xml") == names.end()) {
    return missing(fmt::format("no arena.xml in {}", directory.string()), kInstallAgain);
  }
  return ok(fmt::format("{} in {}", fmt::join(names, ", "), directory.string()));
}

}  // namespace

std::vector<Probe> own_probes() {
  return {fact("Spikeloop", true, build),
          fact("its programs", true, programs),
          {"its libraries", true, linker_lists(), libraries},
          library_probe({"MUSIC library", true, "spikeloop-node", "libmusic", "libmusic1v5"}),
          fact("HDF5", true, [] { return ok(record::library_version()); }),
          library_probe({"MuJoCo", false, "spikeloop-robot", "libmujoco", "libmujoco2.2.2"}),
          library_probe({"roscpp", false, "spikeloop-ros", "libroscpp.", "libroscpp4d"}),
          library_probe({"ddsc", false, "spikeloop-ros", "libddsc.", "libddsc0debian"}),
          fact("worlds", false, worlds)};
}

}  // namespace spikeloop::app::doctor
