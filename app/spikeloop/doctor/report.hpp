// What all probes found, as a table and as data.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "probe.hpp"

namespace spikeloop::app::doctor {

struct Item {
  std::string name;
  bool needed = false;
  Finding finding;
};

/// Starts every probe's programs at once and judges when all have answered or are given up.
std::vector<Item> examine(const std::vector<Probe>& probes);

/// Whether every `spikeloop run` finds what it needs.
bool ready(const std::vector<Item>& items);

/// Two tables with aligned columns, what is needed first; a remedy stands below its line.
std::string table(const std::vector<Item>& items, bool colour);

nlohmann::ordered_json data(const std::vector<Item>& items);

}  // namespace spikeloop::app::doctor
