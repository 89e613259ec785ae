#include "spikeloop/core/plugin.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace spikeloop::plugin {

namespace {

/// Sources are initialised in no order that one could count on: made when the first one comes.
std::vector<MakeClass>& linked() {
  static std::vector<MakeClass> classes;
  return classes;
}

}  // namespace

void note_linked(MakeClass make_class) {
  linked().push_back(make_class);
}

const std::vector<MakeClass>& linked_classes() {
  return linked();
}

PlainDescription::PlainDescription(NodeDescription description)
    : description_(std::move(description)) {
  for (const PortDescription& port : description_.ports) {
    ports_.push_back({port.name.c_str(), port.text.c_str(), static_cast<std::uint32_t>(port.kind),
                      static_cast<std::uint32_t>(port.direction),
                      static_cast<std::uint32_t>(port.width.kind), port.width.value});
  }
  for (const ParameterDescription& parameter : description_.parameters) {
    const std::string& choices =
        joined_choices_.emplace_back(fmt::format("{}", fmt::join(parameter.choices, "|")));
    parameters_.push_back({parameter.name.c_str(), parameter.unit.c_str(),
                           parameter.default_value ? parameter.default_value->c_str() : nullptr,
                           choices.empty() ? nullptr : choices.c_str(), parameter.text.c_str(),
                           parameter.minimum, parameter.maximum,
                           static_cast<std::uint32_t>(parameter.type), 0});
  }
}

namespace {

WeightTable weights_from(const spikeloop_weights& plain) {
  WeightTable table;
  table.kind = WeightTable::Kind::sparse;
  table.rows = plain.rows;
  table.columns = plain.columns;
  table.row_start.assign(plain.row_start, plain.row_start + plain.rows + 1);
  const auto count = table.row_start.back();
  table.column.assign(plain.column, plain.column + count);
  table.values.assign(plain.value, plain.value + count);
  return table;
}

Parameters::Value value_from(const spikeloop_value& plain) {
  switch (plain.type) {
    case SPIKELOOP_INTEGER:
      return plain.integer;
    case SPIKELOOP_BOOLEAN:
      return plain.integer != 0;
    case SPIKELOOP_TEXT:
    case SPIKELOOP_CHOICE:
      return std::string(plain.text);
    case SPIKELOOP_WEIGHTS:
      return weights_from(*plain.weights);
    default:
      return plain.number;
  }
}

}  // namespace

NodeSetup setup_from(const spikeloop_setup& plain) {
  NodeSetup setup;
  setup.name = plain.name;
  setup.seed = plain.seed;
  setup.widths.assign(plain.widths, plain.widths + plain.width_count);
  for (std::uint32_t i = 0; i < plain.value_count; ++i) {
    const spikeloop_value& value = plain.values[i];
    setup.parameters.set(value.name, value_from(value), value.given != 0);
  }
  return setup;
}

}  // namespace spikeloop::plugin
