// Reads whole text files and tells where in them a byte stands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

/// As read_file(), and noted as a file that was read.
std::string read_text_file(const std::filesystem::path& path, std::uint64_t limit,
                           std::string_view kind);

/// Line and column (in characters) of a byte; "\n", "\r\n" and a lone "\r" end a line.
Location locate(std::string_view text, std::size_t offset, const std::string& file);

}  // namespace spikeloop
