#include "signal_function.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include "spikeloop/core/code.hpp"

namespace spikeloop {

SignalFunction::SignalFunction(const NodeSetup& setup)
    : policy_(setup), held_(setup.widths[0], 0.0) {}

void SignalFunction::step(const Step& step) {
  const SignalInput input = step.signal_input();
  const SignalOutput output = step.signal_output();
  if (input.revision == revision_) {
    return;
  }
  revision_ = input.revision;
  if (!input.valid()) {
    output.invalidate();
    return;
  }
  for (std::size_t j = 0; j < held_.size(); ++j) {
    const double value = policy_.treat(input.values[j], j);
    if (!std::isnan(value)) {
      held_[j] = value;
    }
  }
  apply(held_, output.values());
  output.commit();
  ++updates_;
}

std::vector<Counter> SignalFunction::counters() const {
  std::vector<Counter> counters = {{"updates", updates_}};
  policy_.append_counters(counters);
  return counters;
}

NodeDescription signal_function_description(std::vector<ParameterDescription> parameters) {
  NodeDescription description;
  description.ports = {{"in", PortKind::signal, Direction::input, {}, "The values to map"},
                       {"out", PortKind::signal, Direction::output, {}, "One value per channel"}};
  description.parameters = std::move(parameters);
  append_finite_input_policy(description.parameters);
  return description;
}

void require_equal_widths(const NodeSetup& setup) {
  if (setup.widths[0] != setup.widths[1]) {
    throw ConfigurationError(
        with_code(Code::widths_differ,
                  "port 'in' has {} channels and port 'out' {}; make both connections equally "
                  "wide",
                  setup.widths[0], setup.widths[1]));
  }
}

}  // namespace spikeloop
