#include "spikeloop/command/mapping.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/fused/transport.hpp"

namespace spikeloop::fused {

void add_safety(const CommandSpec& spec, command::CommandSettings& settings) {
  const experiment::Part& part = spec.part;
  settings.fields = command::field_paths(part.mapping);
  if (part.parameters.text("limits") != experiment::kNoLimits) {
    settings.bounds = command::default_bounds(part.mapping, std::move(settings.bounds));
  }
  settings.sensors = spec.sensors;
  settings.spike_widths = spec.spike_widths;
  settings.spike_timeout = experiment::spike_timeout(part);
  settings.emergency_stop = experiment::emergency_stop(part, spec.ros);
  settings.manual = experiment::manual_override(part);
}

}  // namespace spikeloop::fused
