// What the codes of errors mean.
#pragma once

#include <span>
#include <string>

#include "spikeloop/core/code.hpp"

namespace spikeloop::app {

struct Explanation {
  Code code;
  const char* title;
  const char* text;        ///< why it is an error, and what to do
  const char* wrong = "";  ///< a line of an experiment; empty when no single line shows it
  const char* right = "";
};

/// In the order of the codes; every code has one.
std::span<const Explanation> explanations();

/// Of "SL0103", "sl103" or "103"; null when there is none.
const Explanation* find_explanation(std::string text);

}  // namespace spikeloop::app
