// `spikeloop` as a user starts it, in a directory.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {

inline Outcome spikeloop(std::vector<std::string> arguments, const TemporaryDirectory& directory) {
  arguments.insert(arguments.begin(), SPIKELOOP_PROGRAM);
  return run({.arguments = std::move(arguments),
              .environment = {{"SPIKELOOP_PLUGIN_PATH", ""}, {"SPIKELOOP_OUT", ""}},
              .directory = directory.path().string()});
}

}  // namespace spikeloop::test
