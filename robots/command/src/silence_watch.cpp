#include "spikeloop/command/silence_watch.hpp"

namespace spikeloop::command {

SilenceWatch::SilenceWatch(std::vector<TimeNs> timeouts) {
  for (const TimeNs timeout : timeouts) {
    sources_.push_back({timeout});
  }
}

void SilenceWatch::heard(std::size_t source, TimeNs at) {
  sources_[source].heard = at;
}

std::optional<std::size_t> SilenceWatch::silent(TimeNs now) const {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& source = sources_[i];
    if (source.timeout != 0 && (!source.heard || now - *source.heard > source.timeout)) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace spikeloop::command
