#include "spikeloop/command/age_meter.hpp"

#include <algorithm>
#include <cmath>

namespace spikeloop::command {
namespace {

double percentile_ms(const std::vector<TimeNs>& sorted, double fraction) {
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * double(sorted.size())));
  return 1e-6 * static_cast<double>(sorted[std::max<std::size_t>(rank, 1) - 1]);
}

}  // namespace

std::optional<TimeNs> AgeMeter::update(double arrived_s, TimeNs now) {
  if (!std::isfinite(arrived_s)) {
    return std::nullopt;
  }
  const TimeNs arrived = from_seconds(arrived_s);
  const TimeNs age = std::max<TimeNs>(0, now - arrived);
  age_max_ = std::max(age_max_, age);
  if (arrived_s != newest_) {
    newest_ = arrived_s;
    waiting_.push_back({arrived, now});
  }
  return age;
}

void AgeMeter::settle(TimeNs sent, const std::function<void(TimeNs)>& take) {
  for (const Message& message : waiting_) {
    const TimeNs latency = std::max<TimeNs>(0, std::max(sent, message.ticked) - message.arrived);
    latencies_[messages_ % kKept] = latency;
    ++messages_;
    if (take) {
      take(latency);
    }
  }
  waiting_.clear();
}

AgeMeter::Report AgeMeter::report() const {
  Report report;
  report.messages = messages_;
  if (messages_ == 0) {
    return report;
  }
  std::vector<TimeNs> sorted(
      latencies_.begin(),
      latencies_.begin() + static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(messages_, kKept)));
  std::ranges::sort(sorted);
  report.latency_median_ms = percentile_ms(sorted, 0.5);
  report.latency_p99_ms = percentile_ms(sorted, 0.99);
  report.age_max_ms = 1e-6 * static_cast<double>(age_max_);
  return report;
}

}  // namespace spikeloop::command
