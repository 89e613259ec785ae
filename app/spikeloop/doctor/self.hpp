// What is looked at by a child of our own program, because it may hang or crash: a plug-in's
// loading, a name's resolution, a master that does not answer.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "probe.hpp"

namespace spikeloop::app::doctor {

/// The child's part: `spikeloop doctor --probe WHAT [ARGUMENT]`. Prints a finding as JSON.
int look_as_child(const std::vector<std::string>& what);

/// The parent's: a probe that such a child does.
Probe child_probe(std::string name, bool needed, const std::vector<std::string>& what,
                  std::function<Finding(const std::string&)> failed);

// What children look at.
Finding look_at_plugin(const std::string& path);
Finding look_at_master();
Finding look_at_host();
Finding look_at_cyclone();

}  // namespace spikeloop::app::doctor
