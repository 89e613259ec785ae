#include "spikeloop/launch/folders.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::launch {

namespace fs = std::filesystem;

std::string directory_of(const std::string& file) {
  std::error_code ignored;
  return fs::absolute(file, ignored).parent_path().string();
}

std::string make_folder(const std::string& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error);
  fs::create_directories(whole, error);
  if (error && fs::is_symlink(fs::symlink_status(whole))) {
    throw FileError(with_code(Code::no_access,
                              "cannot make the folder '{}': it is a symbolic link to nothing; "
                              "remove the link, or give another folder",
                              path));
  }
  if (error) {
    throw FileError("make the folder", path, error.value());
  }
  return whole.lexically_normal().string();
}

namespace {

/// A run that writes its log into a pipe would wait for a reader.
void refuse_pipes(const std::string& path) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(path, ignored)) {
    const auto kind = fs::status(entry.path(), ignored).type();
    if (kind == fs::file_type::fifo || kind == fs::file_type::character ||
        kind == fs::file_type::block) {
      throw FileError(with_code(Code::no_access,
                                "cannot write into the run folder: '{}' in it is a pipe or a "
                                "device; take it away, or give another folder with --out",
                                entry.path().string()));
    }
  }
}

}  // namespace

Descriptor lock_folder(const std::string& path, const std::string& as_written) {
  refuse_pipes(path);
  Descriptor folder{open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  // Some network file systems know no such locks: then there is none.
  if (flock(folder.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw FileError(with_code(Code::no_access,
                              "another run that has not ended writes to the folder '{}'; wait "
                              "for its end, or give another folder with --out",
                              as_written));
  }
  return folder;
}

void refuse_to_overwrite(const std::string& file, const std::string& path) {
  std::error_code ignored;
  if (fs::equivalent(file, path, ignored)) {
    throw ConfigurationError(with_code(Code::no_access,
                                       "the file '{}' would be overwritten with what is made from "
                                       "it; give another folder with --out",
                                       file));
  }
}

}  // namespace spikeloop::launch
