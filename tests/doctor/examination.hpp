// `spikeloop doctor --json`, as a test reads it.
#pragma once

#include <sys/stat.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/launch/launcher.hpp"

namespace spikeloop::test {

using Environment = std::map<std::string, std::string>;

/// A directory of programs that behave as their scripts say.
class Fakes {
 public:
  std::string add(const std::string& name, const std::string& script) const {
    const std::string file = directory_.write(name, "#!/bin/sh\n" + script + "\n");
    chmod(file.c_str(), 0755);
    return file;
  }
  std::string path() const { return directory_.path().string(); }
  std::string before(const char* others = "/usr/bin:/bin") const { return path() + ":" + others; }

 private:
  TemporaryDirectory directory_;
};

/// A Python whose every module answers at once: to import the real ones takes three seconds of a
/// processor, and those tests that are about them say kRealPython.
inline const std::string& quick_python() {
  static const Fakes fakes;
  static const std::string python = fakes.add(
      "python3", "[ \"$1\" = --version ] && echo Python 3.99 || echo '{\"version\": \"1\"}'");
  return python;
}
inline const Environment::value_type kRealPython{"PYTHON", ""};

/// No master, no plug-ins, no Python of the developer's.
inline Command doctor(const std::vector<std::string>& arguments, const Environment& environment) {
  Command command = launcher({"doctor"});
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  command.environment["SPIKELOOP_PLUGIN_PATH"] = "";
  command.environment["PYTHON"] = quick_python();
  command.environment["ROS_MASTER_URI"] = "http://127.0.0.1:1";
  for (const auto& [name, value] : environment) {
    command.environment[name] = value;
  }
  return command;
}

struct Examination {
  Outcome outcome;
  nlohmann::json report;

  nlohmann::json item(const std::string& name) const {
    for (const auto& found : report.value("items", nlohmann::json::array())) {
      if (found["name"] == name) {
        return found;
      }
    }
    return {{"name", name}, {"status", "not there"}, {"text", outcome.err}, {"remedy", ""}};
  }
  /// "missing | no mpirun in PATH (/nowhere) | apt-get ..."
  std::string line(const std::string& name) const {
    const auto found = item(name);
    return found["status"].get<std::string>() + " | " + found["text"].get<std::string>() + " | " +
           found["remedy"].get<std::string>();
  }
  std::string status(const std::string& name) const { return item(name)["status"]; }
};

inline Examination examination_by(const Command& command) {
  Examination seen;
  seen.outcome = run(command);
  seen.report = nlohmann::json::parse(seen.outcome.out, nullptr, false);
  return seen;
}
inline Examination examine(const Environment& environment) {
  return examination_by(doctor({"--json"}, environment));
}

}  // namespace spikeloop::test
