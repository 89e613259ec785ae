// An environment in Python, as the library that runs Python gives it. No exception crosses its
// border.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/core/plugin.h"
#include "spikeloop/environments/environment.hpp"

namespace spikeloop::environments {

/// As Environment. Functions that return a text: what went wrong; empty: nothing.
class Script {
 public:
  virtual ~Script() = default;
  virtual const Description& description() const = 0;
  virtual std::string reset(std::uint64_t seed, std::uint64_t episode,
                            std::vector<double>& observation) = 0;
  virtual std::string step(double action, std::vector<double>& observation, Outcome& outcome) = 0;
};

inline constexpr const char* kMakeScript = "spikeloop_make_environment";
/// Null: `error` says why.
using MakeScript = Script* (*)(const std::string& source, const spikeloop_host& host,
                               std::string& error);

}  // namespace spikeloop::environments
