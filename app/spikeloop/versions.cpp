#include "versions.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "doctor/report.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::app {
namespace {

using nlohmann::json;

/// A probe of the doctor's, and the key that its version has.
struct VersionKey {
  const char* probe;
  const char* key;
};

/// "4.1.4" of "4.1.4, /usr/bin/mpirun", "2.2.2" of "/lib/libmujoco.so.2.2.2".
json version_in(const doctor::Item& item) {
  if (item.finding.status == doctor::Status::missing) {
    return nullptr;
  }
  std::string text = item.finding.text.substr(0, item.finding.text.find(", "));
  constexpr std::string_view kLibrary = ".so.";
  if (const auto at = text.rfind(kLibrary); at != std::string::npos) {
    text.erase(0, at + kLibrary.size());
  }
  constexpr std::string_view kPython = "Python ";
  return text.starts_with(kPython) ? text.substr(kPython.size()) : text;
}

json ask(std::vector<doctor::Probe> probes, const std::vector<VersionKey>& nodes) {
  std::erase_if(probes, [&](const doctor::Probe& probe) {
    return std::ranges::none_of(nodes,
                                [&](const VersionKey& node) { return probe.name == node.probe; });
  });
  json versions = json::object();
  for (const doctor::Item& item : doctor::examine(probes)) {
    const auto node = std::ranges::find_if(
        nodes, [&](const VersionKey& wanted) { return item.name == wanted.probe; });
    versions[node->key] = version_in(item);
  }
  return versions;
}

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if ((line.starts_with("model name") || line.starts_with("Model")) &&
        colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "";
}

json machine() {
  utsname system{};
  uname(&system);
  const std::string cpu = cpu_model();
  return {{"cpu", cpu.empty() ? json(nullptr) : json(cpu)},
          {"cores", std::thread::hardware_concurrency()},
          {"architecture", system.machine},
          {"kernel", fmt::format("{} {}", system.sysname, system.release)}};
}

}  // namespace

Partners partners_of(const experiment::Experiment& experiment, bool separate) {
  return {.music = separate,
          .ros1 = experiment.ros == experiment::Ros::ros1,
          .ros2 = experiment.ros == experiment::Ros::ros2,
          .mujoco = experiment.robot.has_value(),
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

json about_run(const Partners& partners) {
  std::vector<doctor::Probe> probes = doctor::own_probes();
  std::vector<VersionKey> nodes{{"HDF5", "hdf5"}};
  const auto add = [&](bool takes_part, std::vector<doctor::Probe> more,
                       const std::vector<VersionKey>& named) {
    if (takes_part) {
      std::ranges::move(more, std::back_inserter(probes));
      nodes.insert(nodes.end(), named.begin(), named.end());
    }
  };
  add(partners.music, doctor::mpi_probes(""), {{"MUSIC launcher", "music"}, {"Open MPI", "mpi"}});
  add(partners.ros1, {}, {{"roscpp", "roscpp"}});
  add(partners.ros2, {}, {{"ddsc", "cyclonedds"}});
  add(partners.mujoco, {}, {{"MuJoCo", "mujoco"}});
  add(partners.python, doctor::python_probes(), {{"Python", "python"}, {"numpy", "numpy"}});
  json versions = ask(std::move(probes), nodes);
  versions["spikeloop"] = SPIKELOOP_VERSION;
  versions["compiler"] = fmt::format("gcc {}", __VERSION__);
  versions["build"] = SPIKELOOP_BUILD_TYPE;
  return {{"versions", versions}, {"machine", machine()}};
}

}  // namespace spikeloop::app
