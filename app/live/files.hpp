// Files that the server gives: those of the page, and some of the run folder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace spikeloop::view {

struct Answer {
  unsigned status = 404;
  std::string type;
  std::string body;
};

/// @param path of the URL, "/", "/raster.js", "/run/trajectory.csv"
/// @param range of the request, "bytes=100-"; empty: all
/// @param page folder of the page
/// @param run folder of the run; empty: none
Answer answer(std::string_view path, std::string_view range, const std::string& page,
              const std::string& run);

}  // namespace spikeloop::view
