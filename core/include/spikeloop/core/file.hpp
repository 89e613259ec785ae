// Whole files. Reading ends whatever is under the path: somebody else may have written it.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace spikeloop {

/// A pipe would be waited for, and a device has no end.
/// @throws FileError: there is none, or it is not a regular file; `kind` says what to write
/// ("world").
void require_regular_file(const std::string& path, std::string_view kind);

enum class Links { follow, refuse };

/// Opens a regular file for reading. A pipe is not waited for.
/// @param links if the last part of the path is a symbolic link, which can lead out of its folder
/// @return descriptor, to be closed by the caller
/// @throws FileError as above
int open_regular_file(const std::string& path, std::string_view kind, Links links);

/// The whole of a regular file.
/// @throws FileError as above, and when it cannot be read; ConfigurationError when it has more
/// bytes than `limit`.
std::string read_file(const std::string& path, std::string_view kind, std::uint64_t limit);

/// Writes a new file next to `path` and renames it, so that no reader sees half a file. Replaces a
/// symbolic link, as create_file() does.
/// @throws FileError
void write_file(const std::string& path, std::string_view text);

/// Creates a file for writing. Removes a file or symbolic link of that name first: another user who
/// can write to the folder could have made a link to any file of ours. Opens pipes, devices, and
/// files of /dev and /proc (/dev/stdout), without creating or removing anything.
/// @returns a file descriptor, which the caller closes
/// @throws FileError
int create_file(const std::string& path);

/// create_file() as a stream. @throws FileError
std::ofstream create_stream(const std::string& path);

/// create_file() for a library that opens the file itself. Libraries seldom report the system's
/// reason for an error; this function does. @throws FileError
void make_empty_file(const std::string& path);

/// Copies the contents of `from` to a file that create_file() makes. @throws FileError
void copy_to_new_file(const std::string& from, const std::string& to);

}  // namespace spikeloop
