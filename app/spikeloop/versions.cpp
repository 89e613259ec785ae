#include "versions.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "own_programs.hpp"
#include "python_package.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/processes/python.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::app {
namespace {

using doctor::Answer;
using doctor::Finding;
using doctor::found;
using doctor::missing;
using doctor::Probe;
using nlohmann::json;

constexpr const char* kNestMpiRemedy =
    "jobs need one with MUSIC (cmake -Dwith-music=ON -Dwith-mpi=ON), or one without MPI "
    "(conda-forge: nest-simulator=*=nompi*)";

/// NEST's build options are in a dictionary of SLI.
constexpr const char* kPackageScript = R"(
import importlib, json, os, sys
name = sys.argv[1]
module = importlib.import_module(name)
about = {'version': str(getattr(module, '__version__', '?')),
         'place': os.path.dirname(str(module.__file__))}
if name == 'nest':
    for part in ('music', 'mpi'):
        about[part] = bool(module.ll_api.sli_func(f'statusdict/have_{part} ::'))
print()
print(json.dumps(about))
)";

/// From the names of installed packages: in less than half of the time of an import. A run waits
/// for it.
constexpr const char* kInstalledScript = R"(
import os, sys
head = sys.argv[1] + '-'
for folder in filter(os.path.isdir, sys.path):
    for name in os.listdir(folder):
        if name.startswith(head) and name.endswith('-info'):
            print('{"version": "%s"}' % os.path.splitext(name[len(head):])[0].split('-')[0])
            sys.exit()
)";

/// What `PATH --version` prints after `before`. Without a path the probe has its finding already.
Probe program(Probe probe, const std::string& path, const std::string& before) {
  if (!path.empty()) {
    probe.finding.text = path + ": ";
    probe.command = {path, "--version"};
    probe.judge = [path, before](const Answer& answer) {
      const std::string line = answer.out.substr(0, answer.out.find('\n'));
      return line.starts_with(before)
                 ? found(line.substr(before.size()), path)
                 : missing(fmt::format("{} is another program: '{}'", path, line));
    };
  }
  return probe;
}

/// A library as one of our programs loads it. Its version is in its file's name, behind ".so.".
Probe library(Probe probe, const std::string& program, const std::string& file) {
  probe.command = doctor::linker_list({program});
  probe.judge = [program, file](const Answer& answer) {
    for (const auto& [library, path] : doctor::libraries_in(answer.out)) {
      std::error_code error;
      const std::string real = std::filesystem::canonical(path, error).string();
      if (const auto suffix = real.rfind(".so."); library.starts_with(file) && !error) {
        return found(suffix == std::string::npos ? "?" : real.substr(suffix + 4), real);
      }
    }
    return missing(fmt::format("no {}so for {}", file, program));
  };
  return probe;
}

Finding judge_package(const Answer& answer) {
  const std::string_view line = doctor::last_line(answer.out);
  const json about = json::parse(line, nullptr, false);
  if (!about.is_object()) {
    return missing(fmt::format("its answer cannot be read: '{}'", line));
  }
  Finding finding = found(about.value("version", "?"), about.value("place", ""));
  if (about.value("music", false)) {
    finding.text += ", with MUSIC";
  } else if (about.value("mpi", false)) {  // such a NEST takes the whole job for its own
    finding.status = doctor::Status::warning;
    finding.text += ", with MPI but without MUSIC";
    finding.remedy = kNestMpiRemedy;
  } else if (about.contains("music")) {
    finding.text += ", without MUSIC";
  }
  return finding;
}

/// A package of Python's, which is imported.
Probe package(const char* name, const char* module, const std::string& remedy) {
  const std::string python = python_program();
  Probe probe{.name = name, .finding = missing("", remedy)};
  if (python.empty()) {
    probe.finding.text = "there is no Python";
  } else {
    probe.command = {python, "-c", kPackageScript, module};
    probe.judge = judge_package;
  }
  return probe;
}

Probe simulator(const char* name, const char* module) {
  const char* const install = experiment::find_simulator(module)->install;
  return package(name, module, fmt::format("{}; see docs/simulators.md", install));
}

json machine() {
  json cpu;
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; cpu.is_null() && std::getline(file, line);) {
    const auto colon = line.find(": ");
    if ((line.starts_with("model name") || line.starts_with("Model")) &&
        colon != std::string::npos) {
      cpu = line.substr(colon + 2);
    }
  }
  utsname system{};
  uname(&system);
  return {{"cpu", cpu},
          {"cores", std::thread::hardware_concurrency()},
          {"architecture", system.machine},
          {"kernel", fmt::format("{} {}", system.sysname, system.release)}};
}

}  // namespace

Partners partners_of(const experiment::Experiment& experiment) {
  return {.music = experiment::needs_music(experiment),
          .ros1 = experiment.ros == experiment::Ros::ros1,
          .ros2 = experiment.ros == experiment::Ros::ros2,
          .mujoco = experiment.robot && !experiment.robot->environment,
          .python = std::ranges::any_of(experiment.nodes, [](const experiment::Node& node) {
            return node.plugin.ends_with(".py") || experiment::is_simulator(node);
          })};
}

Partners partners_of(const MusicFile& file, bool robot) {
  const auto runs_python = [&file](const MusicSection& section) {
    const MusicKey* plugin = file.find_key(section, "plugin");
    const MusicKey* binary = file.find_key(section, "binary");
    return (plugin != nullptr && plugin->value.ends_with(".py")) ||
           (binary != nullptr && binary->value.ends_with(".py"));
  };
  return {.music = true,
          .ros1 = launch::needs_ros(file, 1) || (robot && !launch::needs_ros(file, 2)),
          .ros2 = launch::needs_ros(file, 2),
          .mujoco = robot,
          .python = std::ranges::any_of(file.sections, runs_python)};
}

std::vector<Probe> versions() {
  const auto absent = [](const char* program, const char* package) {
    return missing(doctor::not_in_path(program),
                   fmt::format("apt-get install {}, or add its directory to PATH", package));
  };
  return {library({"MUSIC library", true, missing("", "apt-get install libmusic1v5")},
                  "spikeloop-node", "libmusic."),
          {"HDF5", true, found(record::library_version(), "")},
          program({"Open MPI", true, absent("mpirun", "openmpi-bin")}, doctor::in_path("mpirun"),
                  "mpirun (Open MPI) "),
          program({"MUSIC launcher", true, absent("music", "music-bin")}, doctor::in_path("music"),
                  "MUSIC "),
          library({"MuJoCo", false, missing("", "apt-get install libmujoco2.2.2")},
                  "spikeloop-robot", "libmujoco."),
          library({"roscpp", false, missing("", "apt-get install libroscpp4d")}, "spikeloop-ros",
                  "libroscpp."),
          library({"Cyclone DDS", false, missing("", "apt-get install libddsc0debian")},
                  "spikeloop-ros", "libddsc."),
          simulator("NEST", "nest"),
          simulator("NEURON", "neuron"),
          simulator("Brian2", "brian2"),
          program({"Python", false,
                   missing(fmt::format("no program '{}'", python_name()),
                           "apt-get install python3, or set PYTHON to another one")},
                  python_program(), "Python "),
          package("numpy", "numpy", "apt-get install python3-numpy"),
          package("matplotlib", "matplotlib", "apt-get install python3-matplotlib"),
          package("h5py", "h5py", "apt-get install python3-h5py")};
}

json about_run(const Partners& partners) {
  std::map<std::string, std::string> keys{{"HDF5", "hdf5"}};  // of probes
  const auto add = [&keys](bool takes_part, const std::map<std::string, std::string>& more) {
    if (takes_part) {
      keys.insert(more.begin(), more.end());
    }
  };
  add(partners.music, {{"MUSIC launcher", "music"}, {"Open MPI", "mpi"}});
  add(partners.ros1, {{"roscpp", "roscpp"}});
  add(partners.ros2, {{"Cyclone DDS", "cyclonedds"}});
  add(partners.mujoco, {{"MuJoCo", "mujoco"}});
  add(partners.python, {{"Python", "python"}, {"numpy", "numpy"}});
  std::vector<Probe> probes = versions();
  std::erase_if(probes, [&keys](const Probe& probe) { return !keys.contains(probe.name); });
  for (Probe& probe : probes) {
    std::ranges::replace(probe.command, kPackageScript, kInstalledScript);
  }
  doctor::examine(probes);
  json numbers{{"spikeloop", SPIKELOOP_VERSION},
               {"compiler", fmt::format("gcc {}", __VERSION__)},
               {"build", SPIKELOOP_BUILD_TYPE}};
  for (const Probe& probe : probes) {
    const std::string& version = probe.finding.version;
    numbers[keys[probe.name]] = version.empty() ? json(nullptr) : json(version);
  }
  return {{"versions", numbers}, {"machine", machine()}};
}

}  // namespace spikeloop::app
