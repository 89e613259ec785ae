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

/// True if a file cannot be removed or renamed for a reason that may not prevent writing to it: it
/// is bind-mounted into a container, or only its folder is not writable.
bool prevents_replacement(int error) {
  return error == EBUSY || error == EACCES || error == EPERM || error == EROFS;
}

/// Empties a file that cannot be replaced and opens it. A symbolic link, a file of another user and
/// a file with a second name are refused. -1 with errno `error` if it fails.
int open_existing(const std::string& path, int error) {
  const int file = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  struct stat status {};
  const bool is_ours = file >= 0 && ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) &&
                       status.st_uid == ::geteuid() && status.st_nlink == 1;
  if (is_ours && ::ftruncate(file, 0) == 0) {
    return file;
  }
  if (file >= 0) {
    ::close(file);
  }
  errno = error;
  return -1;
}

/// -1 with errno if it fails.
int open_new(const std::string& path) {
  if (is_stream(path)) {
    return ::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  }
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return prevents_replacement(errno) ? open_existing(path, errno) : -1;
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

/// Returns 0, or the errno of the failure, also if `file` is -1. Closes `file`.
int write_text(int file, std::string_view text) {
  std::ofstream stream = stream_of(file);
  stream << text;
  stream.close();
  return stream ? 0 : (errno == 0 ? EIO : errno);
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
  errno = 0;
  int error = 0;
  if (is_stream(path)) {
    error = write_text(open_new(path), text);
  } else {
    const std::string written = path + ".new";
    std::error_code renamed;
    error = write_text(open_new(written), text);
    if (error == 0) {
      fs::rename(written, path, renamed);
      error = renamed.value();
    }
    if (error != 0) {
      fs::remove(written, renamed);
    }
    if (prevents_replacement(error)) {
      error = write_text(open_existing(path, error), text);
    }
  }
  if (error != 0) {
    throw FileError("write", path, error);
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
