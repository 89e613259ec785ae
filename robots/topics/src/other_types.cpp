#include "spikeloop/topics/other_types.hpp"

#include <fmt/format.h>

#include "spikeloop/core/pacer.hpp"

namespace spikeloop::topics {
namespace {

/// Longest wait for the name of a node after its type. The name of a Fast DDS node may arrive 3 s
/// later, nodes of plain DDS have none.
constexpr TimeNs kIntroduction = kNsPerSecond / 2;

}  // namespace

void OtherTypes::add(const OtherType& other) {
  const std::lock_guard lock(mutex_);
  ++count_;
  waiting_.emplace_back(other, wall_now());
}

std::optional<OtherType> OtherTypes::take() {
  const std::lock_guard lock(mutex_);
  for (auto entry = waiting_.begin(); entry != waiting_.end();) {
    auto& [other, since] = *entry;
    const std::string node = other.node ? other.node() : "";
    if (node.empty() && other.node && wall_now() - since < kIntroduction) {
      ++entry;
      continue;
    }
    if (!node.empty()) {
      other.text += fmt::format("; node {} publishes it", node);
    }
    OtherType ready = std::move(other);
    entry = waiting_.erase(entry);
    if (taken_.insert(ready.text).second) {
      return ready;
    }
  }
  return std::nullopt;
}

std::uint64_t OtherTypes::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

}  // namespace spikeloop::topics
