// environments_trace NAME [slippery]: takes the actions on standard input, and prints every
// observation. When an episode ends, the next one of seed 1 begins.
//
//   reset OBSERVATION...
//   step REWARD TERMINATED SUCCESS OBSERVATION...
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <span>
#include <string>
#include <string_view>

#include "spikeloop/environments/environment.hpp"

namespace {

std::string numbers(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    text += fmt::format(" {:.17g}", value);
  }
  return text;
}

void trace(const char* name, bool slippery) {
  const auto environment = spikeloop::environments::make(name, {.slippery = slippery});
  std::uint64_t episode = 0;
  std::uint64_t steps = 0;
  const auto reset = [&] {
    environment->reset(1, episode++);
    steps = 0;
    fmt::print("reset{}\n", numbers(environment->observation()));
  };
  reset();
  for (std::string action; std::getline(std::cin, action);) {
    const auto outcome = environment->step(std::stod(action));
    fmt::print("step {:.17g} {:d} {:d}{}\n", outcome.reward, outcome.terminated, outcome.success,
               numbers(environment->observation()));
    if (++steps == environment->description().max_steps || outcome.terminated) {
      reset();
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  try {
    trace(count > 1 ? arguments[1] : "", count > 2 && arguments[2] == std::string_view("slippery"));
  } catch (const std::exception& error) {
    fmt::print(stderr, "environments_trace: {}\n", error.what());
    return 1;
  }
}
