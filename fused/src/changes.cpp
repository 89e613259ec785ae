#include "changes.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "spikeloop/core/error.hpp"
#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::fused {
namespace {

/// Several processes of a run may write to the file, whole lines at once.
void append_line(const std::string& path, const std::string& line) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  std::string text = line + "\n";
  if (file.get() >= 0) {
    text = std::string(experiment::kChangesHead) + "\n" + text;
  } else {
    file = Descriptor(::open(path.c_str(), O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC));
  }
  if (file.get() < 0 ||
      ::write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
    throw FileError("write", path, errno);
  }
}

}  // namespace

void Changes::repeat(const std::function<void(const experiment::Change&)>& made) {
  const auto& changes = experiment_.changes;
  while (repeated_ < changes.size() && changes[repeated_].time <= graph_.time()) {
    make(changes[repeated_]);
    made(changes[repeated_++]);
  }
}

void Changes::make(const experiment::Change& change) {
  if (!graph_.change(change.node, change.parameter, change.value) || folder_.empty()) {
    return;
  }
  const std::string path = folder_ + "/" + experiment::kChangesFile;
  try {
    append_line(path,
                experiment::to_text({graph_.time(), change.node, change.parameter, change.value}));
  } catch (const FileError& error) {
    failures_.add(path, error.what());
  }
}

}  // namespace spikeloop::fused
