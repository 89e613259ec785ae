// What an action's error says.
#pragma once

#include <string>

#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {

/// "no error" when the action throws none; an error of another kind passes through.
template <typename Kind = ConfigurationError, typename Action>
std::string error_of(Action&& action) {
  try {
    action();
  } catch (const Kind& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace spikeloop::test
