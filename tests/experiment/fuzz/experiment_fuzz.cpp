// Experiment files under libFuzzer (scripts/fuzz): whatever the bytes are, there is an experiment
// or a list of faults, each with its place, and the first of them is what is thrown when nobody
// collects.
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/experiment/experiment.hpp"

using namespace spikeloop;

namespace {

constexpr const char* kPath = "/nowhere/fuzz.yaml";

void need(bool condition) {
  if (!condition) {
    std::abort();
  }
}

/// Populations of millions are slow, not wrong.
bool has_large_numbers(std::string_view text) {
  int digits = 0;
  for (const char c : text) {
    digits = std::isdigit(static_cast<unsigned char>(c)) != 0 ? digits + 1 : 0;
    if (digits > 3 || c == 'e' || c == 'E') {
      digits = digits > 3 ? digits : (digits > 0 ? 4 : 0);
    }
    if (digits > 3) {
      return true;
    }
  }
  return false;
}

void check(const ExperimentFile& file, bool whole) {
  static const experiment::NodeTypes types;
  spikeloop::Diagnostics faults;
  const experiment::Experiment result = experiment::resolve(file, types, {}, faults);
  for (const spikeloop::Diagnostic& fault : faults) {
    need(!fault.message.empty() && fault.exit_code > 0 && !fault.where.file.empty());
  }
  if (whole && faults.empty()) {
    need(!result.connections.empty() && result.nodes.size() == file.nodes.size());
    for (const experiment::Connection& connection : result.connections) {
      need(connection.width > 0);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  std::vector<std::string> told;
  try {
    const ExperimentFile file = parse_experiment(
        text, kPath, [&](const ConfigurationError& error) { told.emplace_back(error.what()); });
    if (!has_large_numbers(text)) {
      check(file, told.empty());
    }
  } catch (const ConfigurationError& error) {
    told.emplace_back(error.what());
  }
  try {
    parse_experiment(text, kPath);
    need(told.empty());
  } catch (const ConfigurationError& error) {
    need(!told.empty() && told.front() == error.what());
  }
  return 0;
}
