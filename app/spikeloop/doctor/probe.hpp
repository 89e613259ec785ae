// One look at one thing of the machine, as data: what to run for it, and how to judge the answer.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "children.hpp"

namespace spikeloop::app::doctor {

enum class Status : std::uint8_t {
  ok,
  warning,  ///< can be used, but
  missing   ///< is not there, or cannot be used
};

struct Finding {
  Status status = Status::ok;
  std::string text{};                  ///< version and place, or what is wrong
  std::string remedy{};                ///< empty when all is well
  std::string version{};               ///< alone, of what has one
  std::vector<std::string> classes{};  ///< of nodes, that a plug-in has
};

inline Finding ok(std::string text) {
  return {.text = std::move(text)};
}
inline Finding warning(std::string text, std::string remedy = "") {
  return {.status = Status::warning, .text = std::move(text), .remedy = std::move(remedy)};
}
inline Finding missing(std::string text, std::string remedy = "") {
  return {.status = Status::missing, .text = std::move(text), .remedy = std::move(remedy)};
}
/// Something that has a version, and where it is.
inline Finding found(const std::string& version, const std::string& place) {
  return {.text = version + (place.empty() ? "" : ", " + place), .version = version};
}

struct Probe {
  std::string name;
  bool needed = false;  ///< by every `spikeloop run`
  /// Without a command: what is known from the start. With one: what holds when the command fails,
  /// with the reason appended to the text, and the remedy of every finding that has none itself.
  Finding finding{};
  Command command{};
  std::function<Finding(const Answer&)> judge{};  ///< of a command that ended well
  std::function<Finding()> look{};                ///< the part of a child; see apart()
};

/// A probe that may hang or crash: `look` is called by `spikeloop doctor --probe NAME`, a child of
/// ours. An Error that it throws is a finding like `failed`.
Probe apart(std::string name, bool needed, Finding failed, std::function<Finding()> look);

/// The child's part: prints what the probe of this name finds, as JSON.
/// @throws ConfigurationError when there is no such probe
void look_as_child(const std::vector<Probe>& probes, const std::string& name);

/// Runs all commands at once, and completes the findings. @param scratch as of ask()
void examine(std::vector<Probe>& probes, const ScratchFolder* scratch = nullptr);

/// Where a program is that a job would find; empty: nowhere.
std::string in_path(const std::string& program);
/// "no mpirun in PATH='/bin'"
std::string not_in_path(const std::string& program);

/// Makes the dynamic linker list what these programs of ours load.
Command linker_list(const std::vector<std::string>& programs);
/// Of such a list: names of libraries, and their files, or "not found".
std::set<std::pair<std::string, std::string>> libraries_in(const std::string& linker_list);

/// Free shared memory in a directory, and the need of an example.
Finding shared_memory(const std::string& directory);

// All probes but those of versions().
std::vector<Probe> own_probes();      ///< Spikeloop's own programs and files
std::vector<Probe> plugin_probes();   ///< every plug-in of SPIKELOOP_PLUGIN_PATH
std::vector<Probe> machine_probes();  ///< MPI, cores, memory, ROS, drawing

}  // namespace spikeloop::app::doctor
