#include "probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "../output.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::app::doctor {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Finding, status, text, remedy, classes)

namespace {

using nlohmann::json;

/// Whatever a plug-in printed while it was loaded is on lines before it.
Finding read_finding(const Answer& answer) {
  try {
    auto finding = json::parse(last_line(answer.out)).get<Finding>();
    finding.status = std::min(finding.status, Status::missing);  // whoever has printed it
    return finding;
  } catch (const json::exception&) {
    return missing("ends the program that loads it");
  }
}

}  // namespace

Probe apart(std::string name, bool needed, Finding failed, std::function<Finding()> look) {
  return {.name = name,
          .needed = needed,
          .finding = std::move(failed),
          .command = {"/proc/self/exe", "doctor", "--probe=" + name},
          .judge = read_finding,
          .look = std::move(look)};
}

void look_as_child(const std::vector<Probe>& probes, const std::string& name) {
  const auto probe = std::ranges::find_if(
      probes, [&](const Probe& one) { return one.look != nullptr && one.name == name; });
  if (probe == probes.end()) {
    throw ConfigurationError(fmt::format(
        "--probe '{}' is not a probe; leave it out: doctor uses it for its own children", name));
  }
  Finding finding;
  try {
    finding = probe->look();
  } catch (const Error& error) {
    finding = {.status = probe->finding.status, .text = error.what()};
  }
  put_result("\n" + json(finding).dump(-1, ' ', false, json::error_handler_t::replace) + "\n");
}

void examine(std::vector<Probe>& probes, const ScratchFolder* scratch) {
  std::vector<Command> commands;
  std::ranges::transform(probes, std::back_inserter(commands), &Probe::command);
  const std::vector<Answer> answers = ask(commands, scratch);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    Finding& finding = probes[i].finding;
    if (!answers[i].failure.empty()) {
      finding.text += answers[i].failure;
    } else if (!commands[i].empty()) {
      Finding judged = probes[i].judge(answers[i]);
      if (judged.status != Status::ok && judged.remedy.empty()) {
        judged.remedy = finding.remedy;
      }
      finding = std::move(judged);
    }
  }
}

std::string in_path(const std::string& program) {
  const char* const path = std::getenv("PATH");
  // An empty PATH finds nothing: an empty entry of one that is not empty is the working directory.
  return path == nullptr || *path == '\0' ? "" : launch::find_executable(program, ".", path);
}

std::string not_in_path(const std::string& program) {
  const char* const path = std::getenv("PATH");
  return fmt::format("no {} in PATH='{}'", program, path == nullptr ? "" : path);
}

}  // namespace spikeloop::app::doctor
