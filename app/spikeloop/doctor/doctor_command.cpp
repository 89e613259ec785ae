#include "../commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "../output.hpp"
#include "../versions.hpp"
#include "probe.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::app::doctor_command {
namespace {

using doctor::Probe;
using doctor::Status;

constexpr const char* kFooter = R"(Examples:
  spikeloop doctor
  PYTHON=~/nest/bin/python3 spikeloop doctor      checks another Python
  spikeloop doctor --json

Starts no job. Checks that may hang or crash run in separate processes, all at once, and are killed
after {} s. Uses SPIKELOOP_PLUGIN_PATH, ROS_MASTER_URI and ROS 2's variables (docs/ros2.md).

Exit codes: 0 everything that `spikeloop run` always needs is installed, 3 some of it is missing.
Optional software does not change the exit code.)";

constexpr std::array kWords{"ok", "warning", "missing"};            // by Status
constexpr std::array kColours{"\x1b[32m", "\x1b[33m", "\x1b[31m"};  // green, yellow, red

/// As https://no-color.org has it.
bool colour_wanted() {
  const char* const none = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  return isatty(STDOUT_FILENO) == 1 && (none == nullptr || *none == '\0') &&
         (terminal == nullptr || std::string_view(terminal) != "dumb");
}

/// Every node program loads all plug-ins, and ends when it refuses one: two classes of one name.
void refuse_clashes(std::vector<Probe>& probes) {
  std::map<std::string, std::string> owners;
  for (Probe& probe : probes) {
    for (const std::string& node : std::vector(probe.finding.classes)) {
      if (const auto [owner, is_new] = owners.emplace(node, probe.name); !is_new) {
        probe.finding = doctor::missing(
            fmt::format("there is already a node class '{}', of {}", node, owner->second),
            "give it another name, or take one of the two out of SPIKELOOP_PLUGIN_PATH");
      }
    }
  }
}

bool lacks(const Probe& probe) {
  return probe.needed && probe.finding.status == Status::missing;
}

std::string line(const Probe& probe, std::size_t width, bool colour) {
  const auto status = static_cast<std::size_t>(probe.finding.status);
  std::string text = fmt::format("  {}{:<7}{}  {:<{}}  {}\n", colour ? kColours[status] : "",
                                 kWords[status], colour ? "\x1b[0m" : "", one_line(probe.name),
                                 width, one_line(probe.finding.text));
  if (!probe.finding.remedy.empty()) {
    text += fmt::format("{:{}}-> {}\n", "", width + 13, one_line(probe.finding.remedy));
  }
  return text;
}

/// Two tables with aligned columns, what is needed first; a remedy is below its line.
std::string table(const std::vector<Probe>& probes, bool colour) {
  constexpr std::size_t kWidest = 24;  // paths of plug-ins are longer: they do not move the others
  std::size_t width = 0;
  for (const Probe& probe : probes) {
    width = std::max(width, std::min(probe.name.size(), kWidest));
  }
  std::array<std::string, 2> parts;
  std::vector<std::string> absent;
  for (const Probe& probe : probes) {
    parts[probe.needed ? 0 : 1] += line(probe, width, colour);
    if (lacks(probe)) {
      absent.push_back(one_line(probe.name));
    }
  }
  return fmt::format(
      "Needed by spikeloop run:\n{}\nFor some jobs, or for comfort:\n{}\n{}\n", parts[0], parts[1],
      absent.empty() ? "spikeloop run has all that it needs"
                     : fmt::format("spikeloop run lacks {}", fmt::join(absent, ", ")));
}

std::string json_text(const std::vector<Probe>& probes) {
  nlohmann::ordered_json items = nlohmann::ordered_json::array();
  for (const Probe& probe : probes) {
    items.push_back({{"name", one_line(probe.name)},
                     {"status", kWords[static_cast<std::size_t>(probe.finding.status)]},
                     {"needed", probe.needed},
                     {"text", one_line(probe.finding.text)},
                     {"remedy", one_line(probe.finding.remedy)}});
  }
  const nlohmann::ordered_json all{{"spikeloop", SPIKELOOP_VERSION},
                                   {"ready", std::ranges::none_of(probes, lacks)},
                                   {"items", items}};
  return all.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::vector<Probe> all_probes() {
  std::vector<Probe> probes = doctor::own_probes();
  for (const auto& more : {versions(), doctor::machine_probes(), doctor::plugin_probes()}) {
    probes.insert(probes.end(), more.begin(), more.end());
  }
  return probes;
}

int examine(bool json) {
  std::vector<Probe> probes = all_probes();
  std::optional<ScratchFolder> scratch;
  try {
    scratch.emplace();
  } catch (const FileError&) {  // without room for it the machine is examined all the same
  }
  doctor::examine(probes, scratch ? &*scratch : nullptr);
  refuse_clashes(probes);
  put_result(json ? json_text(probes) : table(probes, colour_wanted()));
  return std::ranges::any_of(probes, lacks) ? TransportError::kExitCode : 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  struct Arguments {
    bool json = false;
    std::string probe;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("doctor", "Check the installation and optional software");
  command->add_flag("--json", arguments->json, "Print the results as JSON");
  command->add_option("--probe", arguments->probe, "Internal")->group("");
  command->footer(fmt::format(kFooter, doctor::kPatience.count()));
  command->callback([arguments, &action] {
    action = [arguments] {
      if (!arguments->probe.empty()) {
        doctor::look_as_child(all_probes(), arguments->probe);
        return 0;
      }
      return examine(arguments->json);
    };
  });
}

}  // namespace spikeloop::app::doctor_command
