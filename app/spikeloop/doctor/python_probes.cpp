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

/// Its build options are in a dictionary of SLI.
constexpr const char* kNestScript = R"(
import json, nest, os
has = lambda name: bool(nest.ll_api.sli_func(f'statusdict/have_{name} ::'))
print()
print(json.dumps({'version': str(getattr(nest, '__version__', '?')), 'music': has('music'),
                  'mpi': has('mpi'), 'place': os.path.dirname(os.path.abspath(nest.__file__))}))
)";

constexpr const char* kNestRemedy =
    "install it (conda-forge: nest-simulator=*=nompi*; Ubuntu: ppa:nest-simulator/nest; or from "
    "source, see docs/simulators.md) and write the directory of its package `nest` into PYTHONPATH";
constexpr const char* kNestMpiRemedy =
    "jobs need one with MUSIC (cmake -Dwith-music=ON -Dwith-mpi=ON), or one without MPI "
    "(conda-forge: nest-simulator=*=nompi*)";

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

Finding judge_version(const json& said) {
  return ok(said.value("version", "?"));
}

/// With MUSIC or without both work; with MPI alone it takes the whole job for its own.
Finding judge_nest(const json& said) {
  const auto finding = [&said](const char* options) {
    return fmt::format("{}, {}, {}", said.value("version", "?"), options, said.value("place", "?"));
  };
  if (said.value("music", false)) {
    return ok(finding("with MUSIC"));
  }
  return said.value("mpi", false) ? warning(finding("with MPI but without MUSIC"), kNestMpiRemedy)
                                  : ok(finding("without MUSIC"));
}

using Judge = Finding (*)(const json& said);

Finding judge_import(const Answer& answer, const std::string& remedy, Judge judge) {
  if (const std::string failure = answer.failure(); !failure.empty()) {
    const bool said_why = answer.in_time && answer.exit_code == 1 && !last_line(answer.err).empty();
    return missing(said_why ? std::string(last_line(answer.err)) : failure, remedy);
  }
  const json said = json::parse(last_line(answer.out), nullptr, false);
  if (!said.is_object()) {
    return missing(fmt::format("its answer cannot be read: '{}'", last_line(answer.out)), remedy);
  }
  return judge(said);
}

Probe import_probe(const Package& package, const char* script, Judge judge = judge_version) {
  const std::string interpreter = python_program();
  if (interpreter.empty()) {
    return fact(package.name, false,
                [remedy = package.remedy] { return missing("there is no Python", remedy); });
  }
  return answer_of(package.name, false,
                   {{interpreter, "-c", script, package.module},
                    {{"MPLBACKEND", "Agg"}, {"PYTHONSAFEPATH", "1"}},
                    "",
                    ""},
                   [remedy = std::string(package.remedy), judge](const Answer& answer) {
                     return judge_import(answer, remedy, judge);
                   });
}

Probe interpreter_probe() {
  const std::string interpreter = python_program();
  if (interpreter.empty()) {
    const char* const named = std::getenv("PYTHON");
    return fact("Python", false, [name = std::string(named == nullptr ? "" : named)] {
      return name.empty() ? missing("no /usr/bin/python3", "apt-get install python3, or set PYTHON")
                          : missing(fmt::format("PYTHON is '{}', which is not a program", name),
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
  std::vector<Probe> probes{import_probe({"NEST", "nest", kNestRemedy}, kNestScript, judge_nest)};
  for (const Package& package : kSimulators) {
    probes.push_back(import_probe(package, kVersionScript));
  }
  return probes;
}

}  // namespace spikeloop::app::doctor
