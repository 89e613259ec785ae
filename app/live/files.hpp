// Files that the server gives: those of the page, and some of the run folder.
#pragma once

#include <cstdint>
#include <istream>
#include <memory>
#include <string>
#include <string_view>

namespace spikeloop::view {

struct Answer {
  unsigned status = 404;
  std::string type = "text/plain";
  std::string range{};  ///< Content-Range; empty: none
  std::unique_ptr<std::istream> body{};
  std::uintmax_t size = 0;  ///< of the body, in bytes
};

/// Without a file: its number.
Answer error_answer(unsigned status);

/// @param path of the URL, "/", "/raster.js", "/run/trajectory.csv"
/// @param range of the request, "bytes=100-"; anything else: all, as RFC 9110 (14.2) permits
/// @param page folder of the page
/// @param run folder of the run; empty: none
Answer answer(std::string_view path, std::string_view range, const std::string& page,
              const std::string& run);

}  // namespace spikeloop::view
