// Whole files. Reading ends whatever is under the path: somebody else may have written it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace spikeloop {

/// A pipe would be waited for, and a device has no end.
/// @throws FileError: there is none, or it is not a regular file; `kind` says what to write
/// ("world").
void require_regular_file(const std::string& path, std::string_view kind);

/// The whole of a regular file.
/// @throws FileError as above, and when it cannot be read; ConfigurationError when it has more
/// bytes than `limit`.
std::string read_file(const std::string& path, std::string_view kind, std::uint64_t limit);

/// Writes the whole file beside `path` and renames it, so nobody reads half of it. What is not a
/// regular file (a link, /dev/stdout) is written in place.
/// @throws FileError
void write_file(const std::string& path, std::string_view text);

}  // namespace spikeloop
