// The experiments that `spikeloop new` prints: the files of the folder templates, in which NAME stands
// for the name of the experiment.
#pragma once

#include <string_view>
#include <vector>

namespace spikeloop::app {

struct Template {
  std::string_view name;  ///< of its file, without .yaml
  std::string_view text;
};

const std::vector<Template>& templates();

}  // namespace spikeloop::app
