#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/core/node.hpp"

namespace spikeloop::command {

/// Value of the counter with this name of a sink or a channel.
std::uint64_t counter(const auto& counted, const std::string& name) {
  const std::vector<Counter> counters = counted.counters();
  const auto found = std::ranges::find(counters, name, &Counter::name);
  EXPECT_TRUE(found != counters.end()) << "no counter " << name;
  return found == counters.end() ? 0 : found->value;
}

}  // namespace spikeloop::command
