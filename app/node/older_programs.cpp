#include "older_programs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/core/log.hpp"

namespace spikeloop {
namespace {

struct DialectDefault {
  std::string_view program;
  std::string_view key;
  const char* rma;
  const char* ma;
};

constexpr DialectDefault kDefaults[] = {
    {"nef_encoder", "preset", "rma", "ma"},
};

}  // namespace

void set_dialect_defaults(std::vector<ParameterDescription>& declared, std::string_view program,
                          Dialect dialect) {
  for (const DialectDefault& entry : kDefaults) {
    const auto parameter = std::ranges::find(declared, entry.key, &ParameterDescription::name);
    if (entry.program == program && parameter != declared.end()) {
      parameter->default_value = dialect == Dialect::ma ? entry.ma : entry.rma;
    }
  }
}

std::string dialect_note(std::string_view program) {
  std::string text;
  for (const DialectDefault& entry : kDefaults) {
    if (entry.program == program && std::string_view(entry.rma) != entry.ma) {
      text += fmt::format("{}{}={}", text.empty() ? "" : ", ", entry.key, entry.ma);
    }
  }
  return text.empty() ? "" : fmt::format("Defaults in dialect ma: {}.\n", text);
}

std::vector<std::string> ignored_keys(std::string_view program) {
  // Its rates follow from the neurons.
  return program == "nef_encoder" ? std::vector<std::string>{"rate_min", "rate_max"}
                                  : std::vector<std::string>{};
}

const char* older_spelling_of(std::string_view program, std::string_view key) {
  return program == "nef_encoder" && key == "resolution" ? "neuron_resolution" : nullptr;
}

std::optional<WeightTable> uneven_one_to_one(std::uint32_t inputs, std::uint32_t outputs,
                                             bool strict) {
  if (inputs == outputs) {
    return std::nullopt;
  }
  const std::uint32_t common = std::min(inputs, outputs);
  const std::string widths =
      fmt::format("port 'in' has {} channels and port 'out' {}", inputs, outputs);
  if (strict) {
    throw ConfigurationError(widths + "; make both connections equally wide");
  }
  log::warning("{}: {} from channel {} on {}; make both connections equally wide", widths,
               inputs < outputs ? "outputs" : "inputs", common,
               inputs < outputs ? "stay 0" : "are left out");
  WeightTable table;
  table.kind = WeightTable::Kind::sparse;
  table.rows = outputs;
  table.columns = inputs;
  for (std::uint32_t row = 0; row <= outputs; ++row) {
    table.row_start.push_back(std::min(row, common));
  }
  for (std::uint32_t channel = 0; channel < common; ++channel) {
    table.column.push_back(channel);
    table.values.push_back(1.0);
  }
  return table;
}

}  // namespace spikeloop
