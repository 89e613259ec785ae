#include "acquaintance.hpp"

#include <algorithm>
#include <vector>

#include "inside.h"

namespace spikeloop::ros2 {
namespace {

/// A participant acknowledges what it has been told, and acts on it in another thread.
constexpr auto kBelief = std::chrono::milliseconds(50);

}  // namespace

Acquaintance::Acquaintance(dds_entity_t participant, const RawTopic& any, const Graph& graph)
    : any_(any), graph_(graph) {
  dds_get_guid(participant, &own_);
}

void Acquaintance::subscribe(const std::string& topic, const std::string& type) {
  const std::lock_guard lock(mutex_);
  subscribed_[topic].insert(type);
  announced_.erase(topic);
}

void Acquaintance::unsubscribe(const std::string& topic, const std::string& type) {
  const std::lock_guard lock(mutex_);
  auto& types = subscribed_.at(topic);
  types.erase(types.find(type));
}

bool Acquaintance::with_publishers(const std::string& topic) {
  const std::lock_guard lock(mutex_);
  if (!announced_to_all(topic, subscribed_[topic])) {
    announced_.erase(topic);
    return false;
  }
  const auto now = std::chrono::steady_clock::now();
  return now - announced_.try_emplace(topic, now).first->second >= kBelief;
}

bool Acquaintance::announced_to_all(const std::string& topic,
                                    const std::multiset<std::string>& types) const {
  const std::vector<Writer> writers = graph_.writers(topic);
  return !writers.empty() && std::all_of(writers.begin(), writers.end(), [&](const Writer& writer) {
    return types.contains(writer.type) &&
           (is_same(writer.participant, own_) ||
            have_announced_subscribers(any_.type, &own_, &writer.participant));
  });
}

}  // namespace spikeloop::ros2
