#include "spikeloop/core/write_failures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"

namespace spikeloop {
namespace {

constexpr const char* kStop = "stop";
constexpr const char* kContinue = "continue";
constexpr std::size_t kMostNames = 5;

}  // namespace

std::vector<std::string> on_write_failure_choices() {
  return {kStop, kContinue};
}

OnWriteFailure on_write_failure_of(const std::string& choice) {
  return choice == kContinue ? OnWriteFailure::proceed : OnWriteFailure::stop;
}

std::string to_text(OnWriteFailure policy) {
  return policy == OnWriteFailure::proceed ? kContinue : kStop;
}

std::string list_incomplete(const std::vector<std::string>& paths) {
  if (paths.empty()) {
    return {};
  }
  std::vector<std::string> names;
  for (const std::string& path : std::span(paths).first(std::min(paths.size(), kMostNames))) {
    names.push_back(std::filesystem::path(path).filename().string());
  }
  const std::size_t more = paths.size() - names.size();
  return fmt::format("; incomplete: {}{}", fmt::join(names, ", "),
                     more == 0 ? "" : fmt::format(" and {} more", more));
}

void WriteFailures::add(const std::string& path, const std::string& message) {
  const std::lock_guard lock(mutex_);
  if (std::ranges::find(files_, path) != files_.end()) {
    return;
  }
  if (files_.empty()) {
    first_ = message;
  }
  files_.push_back(path);
  any_.store(true, std::memory_order_release);
}

void WriteFailures::check(OnWriteFailure policy) {
  if (!any()) {
    return;
  }
  if (policy == OnWriteFailure::stop) {
    throw FileError(text());
  }
  if (!warned_.exchange(true)) {
    log::warning("{}", lengthened(text(), "; the run continues without the incomplete files"));
  }
}

std::string WriteFailures::text() const {
  const std::lock_guard lock(mutex_);
  return files_.empty() ? "" : lengthened(first_, list_incomplete(files_));
}

std::vector<std::string> WriteFailures::files() const {
  const std::lock_guard lock(mutex_);
  return files_;
}

void require_not_deleted(int descriptor, const std::string& path) {
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && status.st_nlink == 0) {
    throw FileError(
        with_code(Code::no_access, "cannot write '{}': it has been deleted during the run", path));
  }
}

}  // namespace spikeloop
