// Printing that never ends a run.
#pragma once

#include <cstdio>
#include <string_view>

namespace spikeloop::app {

/// Whoever reads our output may have gone, or the disk be full: what cannot be written is left out.
void put(std::FILE* stream, std::string_view text) noexcept;

}  // namespace spikeloop::app
