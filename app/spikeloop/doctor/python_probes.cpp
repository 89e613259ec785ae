// Python, its packages, and the simulators that are packages of it.
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "../python_package.hpp"
#include "probe.hpp"

namespace spikeloop::app::doctor {
namespace {

using nlohmann::json;

constexpr const char* kVersionScript = R"(
import importlib, json, sys
m = importlib.import_module(sys.argv[1])
print()
print(json.dumps({'version': str(getattr(m, '__version__', '?'))}))
)";

/// NEST 2 and 3 have their build options in a dictionary of SLI, later ones in Python's.
constexpr const char* kNestScript = R"(
import json, nest
try:
    music = bool(nest.ll_api.sli_func('statusdict/have_music ::'))
except Exception:
    info = getattr(nest, 'build_info', {})
    music = bool(info.get('have_music', False))
print()
print(json.dumps({'version': str(getattr(nest, '__version__', '?')), 'music': music}))
)";

constexpr const char* kNestRemedy =
    "build NEST with cmake -Dwith-music=ON -Dwith-mpi=ON (nest-simulator.readthedocs.io), and set "
    "PYTHON to the python3 that imports it";

struct Package {
  const char* name;
  const char* module;
  const char* remedy;
};
constexpr std::array kPackages{
    Package{"numpy", "numpy", "apt-get install python3-numpy"},
    Package{"matplotlib", "matplotlib", "apt-get install python3-matplotlib"},
    Package{"h5py", "h5py", "apt-get install python3-h5py"}};
constexpr std::array kSimulators{
    Package{"NEURON", "neuron", "apt-get install python3-neuron, or python3 -m pip install neuron"},
    Package{"Brian2", "brian2", "apt-get install python3-brian, or python3 -m pip install brian2"}};

Finding judge_import(const Answer& answer, const std::string& remedy) {
  if (const std::string failure = answer.failure(); !failure.empty()) {
    const bool said_why = answer.in_time && answer.exit_code == 1 && !last_line(answer.err).empty();
    return missing(said_why ? std::string(last_line(answer.err)) : failure, remedy);
  }
  const json said = json::parse(last_line(answer.out), nullptr, false);
  if (!said.is_object()) {
    return missing(fmt::format("its answer cannot be read: '{}'", last_line(answer.out)), remedy);
  }
  const std::string version = said.value("version", "?");
  if (!said.contains("music")) {
    return ok(version);
  }
  return said.value("music", false) ? ok(version + ", with MUSIC")
                                    : warning(version + ", without MUSIC", remedy);
}

Probe import_probe(const Package& package, const char* script) {
  const std::string interpreter = python_program();
  if (interpreter.empty()) {
    return fact(package.name, false,
                [remedy = package.remedy] { return missing("there is no Python", remedy); });
  }
  return answer_of(package.name, false,
                   {{interpreter, "-c", script, package.module}, {{"MPLBACKEND", "Agg"}}, "", ""},
                   [remedy = std::string(package.remedy)](const Answer& answer) {
                     return judge_import(answer, remedy);
                   });
}

Probe interpreter_probe() {
  const std::string interpreter = python_program();
  if (interpreter.empty()) {
    const char* const named = std::getenv("PYTHON");
    return fact("Python", false, [name = std::string(named == nullptr ? "" : named)] {
      return name.empty() ? missing("no /usr/bin/python3", "apt-get install python3, or set PYTHON")
                          : missing(fmt::format("PYTHON is '{}', which is no program", name),
                                    "set PYTHON to a python3, or unset it");
    });
  }
  return answer_of("Python", false, {{interpreter, "--version"}, {}, "", ""},
                   [interpreter](const Answer& answer) {
                     const std::string failure = answer.failure();
                     return failure.empty()
                                ? ok(fmt::format("{}, {}", last_line(answer.out), interpreter))
                                : missing(fmt::format("{}: {}", interpreter, failure),
                                          "apt-get install python3, or set PYTHON to another one");
                   });
}

}  // namespace

std::vector<Probe> python_probes() {
  std::vector<Probe> probes{interpreter_probe()};
  for (const Package& package : kPackages) {
    probes.push_back(import_probe(package, kVersionScript));
  }
  return probes;
}

std::vector<Probe> simulator_probes() {
  std::vector<Probe> probes{import_probe({"NEST", "nest", kNestRemedy}, kNestScript)};
  for (const Package& package : kSimulators) {
    probes.push_back(import_probe(package, kVersionScript));
  }
  return probes;
}

}  // namespace spikeloop::app::doctor
