// Messages about a file that was made speak of the one that a user wrote.
#pragma once

#include <functional>
#include <string>

#include "spikeloop/config/music_file.hpp"

namespace spikeloop::app {

/// Puts the places of `origin` in place of those of `written`, which was made from it, in a text:
/// "experiment.music:12:3" becomes "explorer.yaml:7:5". A line of `written` holds one item.
std::function<std::string(const std::string&)> places_of(const MusicFile& written,
                                                         const MusicFile& origin);

}  // namespace spikeloop::app
