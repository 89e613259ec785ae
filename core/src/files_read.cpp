#include "spikeloop/core/files_read.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "spikeloop/core/random.hpp"

namespace spikeloop {
namespace {

thread_local FilesRead* innermost = nullptr;

}  // namespace

FilesRead::FilesRead() : outer_(innermost) {
  innermost = this;
}

FilesRead::~FilesRead() {
  innermost = outer_;
}

void FilesRead::note(const std::string& path) {
  if (innermost != nullptr && !path.empty()) {
    innermost->paths_.insert(std::filesystem::absolute(path).lexically_normal().string());
  }
}

// In blocks, each together with the print of those before: recordings may be larger than memory.
std::string file_print(const std::string& path) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return "";
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return "";
  }
  std::string print;
  std::string block(kBlock, '\0');
  do {
    file.read(block.data(), kBlock);
    print += block.substr(0, static_cast<std::size_t>(file.gcount()));
    print = fmt::format("{:016x}", name_hash(print));
  } while (file);
  return print;
}

}  // namespace spikeloop
