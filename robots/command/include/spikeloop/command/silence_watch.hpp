// Which of several sources has not been heard for too long. A pure function of times.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::command {

class SilenceWatch {
 public:
  /// @param timeouts one a source; 0: it may be silent
  explicit SilenceWatch(std::vector<TimeNs> timeouts);

  /// The newest that came from a source came then.
  void heard(std::size_t source, TimeNs at);
  /// The first source that has been silent for longer than its timeout, or was never heard.
  std::optional<std::size_t> silent(TimeNs now) const;

 private:
  struct Source {
    TimeNs timeout = 0;
    std::optional<TimeNs> heard{};
  };
  std::vector<Source> sources_;
};

}  // namespace spikeloop::command
