// Files that the server gives: those of the page, and some of the run folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::view {

struct Answer {
  unsigned status = 404;
  std::string type = "text/plain";
  std::string range{};       ///< Content-Range. Empty if all of a file is sent
  Descriptor file{};         ///< Without a descriptor, `body` is all
  std::string body{};        ///< instead of a file
  std::uintmax_t begin = 0;  ///< position in the file, in bytes
  std::uintmax_t size = 0;   ///< size of the body in bytes
};

/// An answer whose body is `text`.
Answer error_answer(unsigned status, std::string_view text);

/// @param path of the URL, "/", "/raster.js", "/run/trajectory.csv"
/// @param range header of the request, "bytes=100-"; anything else: all, as RFC 9110 (14.2) permits
/// @param page folder of the page
/// @param run folder of the run. Empty if there is none
Answer answer(std::string_view path, std::string_view range, const std::string& page,
              const std::string& run);

/// The next bytes of the answer, at most `most`. Empty at its end, and if the file has become
/// shorter.
std::string next_piece(Answer& answer, std::size_t most);

}  // namespace spikeloop::view
