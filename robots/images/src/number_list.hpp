// "[1, 2.5]" as numbers.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace spikeloop::images {

/// With or without brackets; nothing when it is something else.
std::optional<std::vector<double>> numbers_of(std::string_view text);

}  // namespace spikeloop::images
