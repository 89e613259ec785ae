#include "text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "spikeloop/config/files_read.hpp"

namespace spikeloop {

namespace {

std::string size_text(std::uint64_t bytes) {
  constexpr std::uint64_t kMega = 1'000'000;
  return bytes >= kMega ? fmt::format("{} MB", bytes / kMega) : fmt::format("{} bytes", bytes);
}

}  // namespace

std::string read_text_file(const std::filesystem::path& path, std::uint64_t limit,
                           std::string_view kind) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::directory) {
    throw FileError("read", path.string(), EISDIR);
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw FileError(fmt::format("cannot read '{}': not a regular file; write the path of a {}",
                                path.string(), kind));
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw FileError("open", path.string(), errno == 0 ? ENOENT : errno);
  }
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (!error && size > limit) {
    throw ConfigurationError(Location{path.string()},
                             fmt::format("the file has {}, more than the {} that a {} may have",
                                         size_text(size), size_text(limit), kind));
  }
  std::string text(error ? 0 : size, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) {
    throw FileError("read", path.string(), EIO);
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  FilesRead::note(path.string());
  return text;
}

Location locate(std::string_view text, std::size_t offset, const std::string& file) {
  Location where{file, 1, 1};
  for (std::size_t i = 0; i < std::min(offset, text.size()); ++i) {
    const char c = text[i];
    if (c == '\n' || (c == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'))) {
      ++where.line;
      where.column = 1;
    } else if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) {  // not inside a UTF-8 character
      ++where.column;
    }
  }
  return where;
}

}  // namespace spikeloop
