#include "spikeloop/core/file.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/files_read.hpp"

namespace spikeloop {
namespace {

namespace fs = std::filesystem;

std::string size_text(std::uint64_t bytes) {
  constexpr std::uint64_t kMega = 1'000'000;
  return bytes >= kMega ? fmt::format("{} MB", bytes / kMega) : fmt::format("{} bytes", bytes);
}

}  // namespace

void require_regular_file(const std::string& path, std::string_view kind) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::directory) {
    throw FileError("read", path, EISDIR);
  }
  if (!fs::exists(status)) {
    throw FileError("open", path, error ? error.value() : ENOENT);
  }
  if (!fs::is_regular_file(status)) {
    throw FileError(with_code(Code::no_access,
                              "cannot read '{}': not a regular file; write the path of a {}", path,
                              kind));
  }
  FilesRead::note(path);
}

std::string read_file(const std::string& path, std::string_view kind, std::uint64_t limit) {
  require_regular_file(path, kind);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw FileError("open", path, errno == 0 ? ENOENT : errno);
  }
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (!error && size > limit) {
    throw ConfigurationError(
        Location{path},
        with_code(Code::out_of_bounds, "the file has {}, more than the {} that a {} may have",
                  size_text(size), size_text(limit), kind));
  }
  std::string text(error ? 0 : size, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) {
    throw FileError("read", path, EIO);
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

void write_file(const std::string& path, std::string_view text) {
  std::error_code error;
  const auto kind = fs::symlink_status(path, error).type();
  error.clear();
  const bool in_place = kind != fs::file_type::not_found && kind != fs::file_type::regular;
  const std::string written = in_place ? path : path + ".new";
  errno = 0;
  std::ofstream file(written, std::ios::binary);
  file << text;
  file.close();
  if (!file) {
    error.assign(errno == 0 ? EIO : errno, std::generic_category());
  } else if (!in_place) {
    fs::rename(written, path, error);
  }
  if (error) {
    const int number = error.value();
    if (!in_place) {
      fs::remove(written, error);
    }
    throw FileError("write", path, number);
  }
}

}  // namespace spikeloop
