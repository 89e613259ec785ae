// A directory of a test's own, removed with everything in it.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace spikeloop::test {

class TemporaryDirectory {
 public:
  /// Kept short: Open MPI puts Unix sockets, whose paths end at 107 characters, below it.
  TemporaryDirectory() {
    std::string name = "/tmp/sl-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("cannot make a temporary directory");
    }
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Writes a file and returns its whole path.
  std::string write(const std::string& name, const std::string& text) const {
    const auto file = path_ / name;
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }

  /// The text of a file; empty when there is none.
  std::string read(const std::string& name) const {
    std::ifstream in(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  /// The complete lines of a file that a running program writes, with their ends.
  std::string read_complete_lines(const std::string& name) const {
    const std::string text = read(name);
    return text.substr(0, text.rfind('\n') + 1);
  }

 private:
  std::filesystem::path path_;
};

}  // namespace spikeloop::test
