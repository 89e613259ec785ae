#include "run_log.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop::app {
namespace {

std::string utc_now() {
  using std::chrono::milliseconds;
  const auto now = std::chrono::system_clock::now();
  const auto part = std::chrono::duration_cast<milliseconds>(now.time_since_epoch()).count() % 1000;
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)), part);
}

}  // namespace

RunLog::RunLog(const std::string& folder) {
  const std::string path = folder + "/log.txt";
  file_ = Descriptor(create_file(path));
  ::fcntl(file_.get(), F_SETFL, O_APPEND);
}

void RunLog::write(std::string_view text) noexcept {
  try {
    const std::string stamp = fmt::format("{} {:>10.3f} s  ", utc_now(), simulated_s_.load());
    std::string lines;
    for (bool more = true; more;) {
      const auto end = text.find('\n');
      more = end != std::string_view::npos && end + 1 < text.size();
      lines += fmt::format("{}{}\n", stamp, one_line(text.substr(0, end)));
      text.remove_prefix(more ? end + 1 : text.size());
    }
    const std::lock_guard lock(mutex_);
    [[maybe_unused]] const auto written = ::write(file_.get(), lines.data(), lines.size());
  } catch (const std::exception&) {
    // Without memory there are other worries.
  }
}

}  // namespace spikeloop::app
