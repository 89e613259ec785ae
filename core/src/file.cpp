#include "spikeloop/core/file.hpp"
#include "spikeloop/core/code.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

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

/// True if writing to `path` reaches something that exists, and makes no file: a pipe, a device, or
/// a descriptor of this process (/dev/stdout is a link that must not be removed).
bool is_stream(const fs::path& path) {
  std::error_code ignored;
  const auto type = fs::symlink_status(path, ignored).type();
  if (type == fs::file_type::symlink) {
    const std::string folder = fs::canonical(fs::absolute(path, ignored).parent_path(), ignored);
    return folder == "/dev" || folder.starts_with("/proc/");
  }
  return type == fs::file_type::fifo || type == fs::file_type::character ||
         type == fs::file_type::block || type == fs::file_type::socket;
}

/// -1 with errno if it fails.
int open_new(const std::string& path) {
  if (is_stream(path)) {
    return ::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  }
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return -1;
  }
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

/// Closes `file`, which the stream opens again by its descriptor: by its name it could be another.
std::ofstream stream_of(int file) {
  std::ofstream stream;
  if (file >= 0) {
    errno = 0;
    stream.open(fmt::format("/proc/self/fd/{}", file), std::ios::binary);
    const int error = stream ? errno : (errno == 0 ? EIO : errno);
    ::close(file);
    errno = error;
  } else {
    stream.setstate(std::ios::failbit);
  }
  return stream;
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

int open_regular_file(const std::string& path, std::string_view kind, Links links) {
  const int flags = O_RDONLY | O_NONBLOCK | O_CLOEXEC | (links == Links::refuse ? O_NOFOLLOW : 0);
  const int file = ::open(path.c_str(), flags);
  const int error = errno;
  struct stat status {};
  if (file >= 0 && ::fstat(file, &status) == 0 && S_ISREG(status.st_mode)) {
    return file;
  }
  if (file >= 0) {
    ::close(file);
  } else if (error != ELOOP) {
    throw FileError("open", path, error);
  }
  throw FileError(with_code(
      Code::no_access, "cannot read '{}': not a regular file; write the path of a {}", path, kind));
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
  const bool in_place = is_stream(path);
  const std::string written = in_place ? path : path + ".new";
  errno = 0;
  std::ofstream file = stream_of(open_new(written));
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

int create_file(const std::string& path) {
  const int file = open_new(path);
  if (file < 0) {
    throw FileError("create", path, errno);
  }
  return file;
}

std::ofstream create_stream(const std::string& path) {
  std::ofstream stream = stream_of(create_file(path));
  if (!stream) {
    throw FileError("create", path, errno);
  }
  return stream;
}

void make_empty_file(const std::string& path) {
  ::close(create_file(path));
}

void copy_to_new_file(const std::string& from, const std::string& to) {
  errno = 0;
  std::ifstream source(from, std::ios::binary);
  if (!source) {
    throw FileError("open", from, errno == 0 ? EIO : errno);
  }
  std::ofstream copy = create_stream(to);
  if (source.peek() != std::ifstream::traits_type::eof()) {  // << of an empty buffer fails
    copy << source.rdbuf();
  }
  copy.close();
  if (!copy || source.bad()) {
    throw FileError("write", to, errno == 0 ? EIO : errno);
  }
}

}  // namespace spikeloop
