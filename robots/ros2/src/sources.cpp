#include "sources.hpp"

#include <algorithm>

#include "inside.h"

namespace spikeloop::ros2 {
namespace {

/// Maximum number of departed writers kept. If it is exceeded, all of them are removed.
constexpr std::size_t kMostKnown = 1'000;

/// A packet that takes longer is lost.
constexpr std::chrono::seconds kOnItsWay{1};

}  // namespace

Sources::Sources(const topics::Subscription& subscription)
    : every_message_(subscription.queue == 0),
      reliable_(every_message_ || subscription.reliable),
      late_(subscription.latched) {}

void Sources::update(const Writer& writer, bool alive) {
  const std::lock_guard lock(mutex_);
  forget_some();
  Source& source = sources_[writer.handle];
  source.guid = writer.guid;
  source.known = true;
  source.alive = alive;
  source.reliable = writer.reliable;
  source.latched = writer.latched;
  if (const bool late = requests_late_messages(); late != late_now_) {
    late_now_ = late;
    for (auto& [handle, other] : sources_) {
      other.settled = false;
    }
  }
}

bool Sources::requests_late_messages() const {
  bool any = false;
  for (const auto& [handle, source] : sources_) {
    any = any || source.alive;
    if (source.alive && !source.latched) {
      return false;
    }
  }
  return late_ && any;
}

Level Sources::level(const Source& source) const {
  if (late_now_ && source.latched) {
    return Level::latched;
  }
  return source.reliable && reliable_ ? Level::reliable : Level::best_effort;
}

std::vector<Level> Sources::levels() const {
  const std::lock_guard lock(mutex_);
  std::vector<Level> levels;
  for (const auto& [handle, source] : sources_) {
    if (source.alive && std::ranges::find(levels, level(source)) == levels.end()) {
      levels.push_back(level(source));
    }
  }
  return levels;
}

std::optional<Level> Sources::level_of(dds_instance_handle_t writer) const {
  const std::lock_guard lock(mutex_);
  const auto found = sources_.find(writer);
  return found == sources_.end() ? std::nullopt : std::optional(level(found->second));
}

bool Sources::all_latched() const {
  const std::lock_guard lock(mutex_);
  return !sources_.empty() &&
         std::ranges::all_of(sources_, [](const auto& entry) { return entry.second.latched; });
}

bool Sources::accept(Level from, dds_instance_handle_t writer, std::int64_t number) {
  const std::lock_guard lock(mutex_);
  come_at_ = std::chrono::steady_clock::now();
  forget_some();
  Source& source = sources_[writer];
  const bool own = !source.known || from == level(source);
  if (!own && (source.settled || level(source) == Level::latched)) {
    return false;  // a latched reader brings all that others have missed, too
  }
  source.settled = source.settled || (source.known && own);
  if (number == 0) {
    return true;
  }
  if (number <= source.newest) {
    return false;
  }
  const std::int64_t before = std::max(source.newest, source.announced);
  if (before != 0 && number > before + 1) {
    lost_ += static_cast<std::uint64_t>(number - before - 1);
  }
  source.newest = number;
  return true;
}

/// Counts what was announced after the newest message of each writer. What was announced before the
/// first look is from before this subscription.
std::uint64_t Sources::lost(const ddsi_sertype* type) {
  const std::lock_guard lock(mutex_);
  std::uint64_t missing = 0;
  for (auto& [handle, source] : sources_) {
    const std::int64_t announced =
        type != nullptr && source.alive ? newest_announced(type, &source.guid) : 0;
    if (announced == 0) {
      continue;
    }
    if (source.newest == 0 && source.announced == 0) {
      source.announced = announced;
    }
    missing += static_cast<std::uint64_t>(
        std::max<std::int64_t>(announced - std::max(source.newest, source.announced), 0));
  }
  const bool silent = std::chrono::steady_clock::now() - come_at_ >= kOnItsWay;
  return lost_ + (silent ? missing : 0);
}

void Sources::forget_some() {
  if (sources_.size() >= kMostKnown) {
    std::erase_if(sources_, [](const auto& entry) { return !entry.second.alive; });
  }
}

}  // namespace spikeloop::ros2
