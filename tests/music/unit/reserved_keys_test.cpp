// What a parameter of a script cannot be named is what all programs read.
#include <gmock/gmock.h>

#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/process/common_keys.hpp"

namespace spikeloop::music {
namespace {

TEST(ReservedKeys, AreTheKeysOfAllProgramsAndMusics) {
  std::vector<std::string> expected = names_of(common_parameters());
  for (const char* name :
       {"binary", "args", "wd", "timebase", "node", "simulator", "script", "experiment_file",
        "spikes_in", "spikes_out", "signals_in", "signals_out", "pace"}) {
    expected.emplace_back(name);
  }
  const auto reserved = experiment::reserved_keys();
  EXPECT_THAT(std::vector<std::string>(reserved.begin(), reserved.end()),
              testing::UnorderedElementsAreArray(expected));
}

}  // namespace
}  // namespace spikeloop::music
