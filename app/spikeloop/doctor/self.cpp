#include "self.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "../output.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::app::doctor {
namespace {

using nlohmann::json;

Finding look(const std::vector<std::string>& what) {
  if (what.size() == 2 && what[0] == "plugin") {
    return look_at_plugin(what[1]);
  }
  if (what.size() == 1 && what[0] == "master") {
    return look_at_master();
  }
  if (what.size() == 1 && what[0] == "host") {
    return look_at_host();
  }
  if (what.size() == 1 && what[0] == "cyclone") {
    return look_at_cyclone();
  }
  throw ConfigurationError(
      fmt::format("--probe '{}' is not a probe; leave it out: doctor uses it for its own children",
                  what.empty() ? "" : what[0]));
}

/// Whatever a plug-in printed while it was loaded stands before.
Finding read_finding(const Answer& answer) {
  const json said = json::parse(last_line(answer.out), nullptr, false);
  if (!said.is_object()) {
    return missing("", "");
  }
  return {static_cast<Status>(said.value("status", 0)), said.value("text", ""),
          said.value("remedy", "")};
}

}  // namespace

int look_as_child(const std::vector<std::string>& what) {
  const Finding finding = look(what);
  const json said{{"status", static_cast<int>(finding.status)},
                  {"text", finding.text},
                  {"remedy", finding.remedy}};
  put_result("\n" + said.dump(-1, ' ', false, json::error_handler_t::replace) + "\n");
  return 0;
}

Probe child_probe(std::string name, bool needed, const std::vector<std::string>& what,
                  std::function<Finding(const std::string&)> failed) {
  launch::ProgramStart start{{"/proc/self/exe", "doctor"}, {}, "", ""};
  for (const std::string& word : what) {
    start.arguments.push_back("--probe=" + word);
  }
  return answer_of(std::move(name), needed, std::move(start),
                   [failed = std::move(failed)](const Answer& answer) {
                     const std::string failure = answer.failure();
                     return failure.empty() ? read_finding(answer) : failed(failure);
                   });
}

}  // namespace spikeloop::app::doctor
