#include <algorithm>

#include "spikeloop/status/status.hpp"

namespace spikeloop::status {

void add_summary(const nlohmann::json& summary, nlohmann::json& sum) {
  const nlohmann::json before = sum;
  sum.update(summary);
  const auto combine = [&](const char* key, auto&& both) {
    if (!before.contains(key) || !summary.contains(key)) {
      return;
    }
    if (!summary[key].is_number()) {
      sum[key] = before[key];  // null: this one has measured nothing
    } else if (before[key].is_number()) {
      sum[key] = both(before[key], summary[key]);
    }
  };
  for (const char* count : {"spikes", "scans", "commands", "spikes_recorded", "records_dropped"}) {
    combine(count, [](const auto& a, const auto& b) {
      return a.template get<std::uint64_t>() + b.template get<std::uint64_t>();
    });
  }
  for (const char* time : {"latency_median_ms", "latency_p99_ms", "age_max_ms", "stopped_s"}) {
    combine(time, [](const auto& a, const auto& b) { return std::max(a, b); });
  }
}

}  // namespace spikeloop::status
