#include "spikeloop/config/dialect.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace spikeloop {

namespace {

constexpr std::array<std::string_view, 5> kOnlyRma = {"ros_sensor_adapter", "ros_command_adapter",
                                                      "ros_event_sensor_adapter", "connect_adapter",
                                                      "linear_readout_decoder"};
constexpr std::array<std::string_view, 10> kOnlyMa = {
    "ros_cont_adapter",   "cont_ros_adapter",  "zmq_cont_adapter", "cont_zmq_adapter",
    "cont_cont_adapter",  "threshold_adapter", "sigmoid_adapter",  "argmax_adapter",
    "discretize_adapter", "linear_decoder"};

/// The first program that is one of these; empty when none is.
std::string first_of(const std::vector<std::string>& programs, const auto& names) {
  const auto found = std::ranges::find_first_of(programs, names);
  return found == programs.end() ? "" : *found;
}

}  // namespace

std::string program_of(const MusicSection& section) {
  const MusicKey* binary = find_key(section.keys, "binary");
  return binary == nullptr ? "" : std::filesystem::path(binary->value).filename().string();
}

std::vector<std::string> programs_of(const MusicFile& file) {
  std::vector<std::string> programs;
  programs.reserve(file.sections.size());
  for (const MusicSection& section : file.sections) {
    programs.push_back(program_of(section));
  }
  return programs;
}

Dialect dialect_of_job(const std::vector<std::string>& programs) {
  const std::string rma = first_of(programs, kOnlyRma);
  const std::string ma = first_of(programs, kOnlyMa);
  if (!rma.empty() && !ma.empty()) {
    throw ConfigurationError(with_code(
        Code::unknown_choice,
        "dialect=auto cannot choose: {} is a program of dialect rma, and {} one of dialect ma; "
        "write dialect=rma or dialect=ma",
        rma, ma));
  }
  return ma.empty() ? Dialect::rma : Dialect::ma;
}

Dialect dialect_named(std::string_view text, const std::vector<std::string>& programs) {
  if (text == "auto") {
    return dialect_of_job(programs);
  }
  return text == "ma" ? Dialect::ma : Dialect::rma;
}

}  // namespace spikeloop
