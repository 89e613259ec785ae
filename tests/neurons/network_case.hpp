// A network file that is wrong, and what is said of it.
#pragma once

#include <gmock/gmock.h>

#include "run_network.hpp"
#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {

struct NetworkCase {
  const char* name;
  std::string text;
  std::string message;
};

inline void expect_its_message(const NetworkCase& wrong, const NetworkWeightLoader& load = {}) {
  try {
    parse(wrong.text, load);
    FAIL() << "it was accepted";
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), Fault(wrong.message));
  }
}

}  // namespace spikeloop::test
