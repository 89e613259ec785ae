#include "reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "inside.h"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::ros2 {
namespace {

/// Of one topic at a time, so that a busy one does not hold up the others.
constexpr int kMostAtOnce = 16;

/// Writers that have come and gone; a reader that outlives as many looks again at those there are.
constexpr std::size_t kMostKnown = 1'000;

/// Cyclone DDS tells of a writer a moment before it connects it.
constexpr std::chrono::microseconds kLook{100};
constexpr int kMostLooks = 100;

/// Nothing that takes longer is on its way any more.
constexpr std::chrono::seconds kOnItsWay{1};

using MatchedWriter =
    std::unique_ptr<dds_builtintopic_endpoint_t, decltype(&dds_builtintopic_free_endpoint)>;

MatchedWriter matched(dds_entity_t reader, dds_instance_handle_t writer) {
  return {dds_get_matched_publication_data(reader, writer), &dds_builtintopic_free_endpoint};
}

}  // namespace

Reader::Reader(Session::Impl& session, const RawTopic& topic, const Qos& qos, Writers writers,
               std::function<void(std::span<const std::byte>)> take)
    : session_(session),
      type_(topic.type),
      writers_(writers),
      take_(std::move(take)),
      reader_(dds_create_reader(session.participant.entity(), topic.entity, qos.get(), nullptr)),
      arrived_(dds_create_readcondition(reader_, DDS_ANY_STATE)) {
  if (arrived_ < 0) {
    const char* const reason = dds_strretcode(reader_ < 0 ? reader_ : arrived_);
    dds_delete(reader_);
    throw TransportError(with_code(Code::ros_setting, "Cyclone DDS makes no reader of '{}': {}",
                                   topic.name, reason));
  }
  session_.nodes.add_reader(reader_);
  ticket_ = session_.dispatcher.add(arrived_, [this] { take_some(); });
}

Reader::~Reader() {
  session_.dispatcher.remove(ticket_, arrived_);
  session_.nodes.remove(reader_);
  dds_delete(reader_);
}

bool Reader::has_writers() const {
  dds_subscription_matched_status_t status{};
  return dds_get_subscription_matched_status(reader_, &status) == DDS_RETCODE_OK &&
         status.current_count > 0;
}

void Reader::meet(const Writer& writer) const {
  dds_guid_t own{};
  dds_get_guid(reader_, &own);
  for (int i = 0; i < kMostLooks && !take_first_message(type_, &writer.guid, &own); ++i) {
    std::this_thread::sleep_for(kLook);
  }
}

// One by one: what waits beyond the queue is lost, and nothing waits elsewhere.
void Reader::take_some() {
  for (int i = 0; i < kMostAtOnce; ++i) {
    const TakenMessage taken(reader_);
    if (!taken.any()) {
      return;
    }
    if (taken.valid() && is_wanted(taken.writer())) {
      count_lost(taken);
      take_(taken.message());
    }
  }
}

void Reader::count_lost(const TakenMessage& taken) {
  const std::lock_guard lock(mutex_);
  come_at_ = std::chrono::steady_clock::now();
  if (taken.number() == 0) {
    return;
  }
  if (newest_.size() >= kMostKnown) {
    newest_.clear();
  }
  const auto [newest, is_first] = newest_.try_emplace(taken.writer(), taken.number());
  if (!is_first && taken.number() > newest->second) {
    lost_ += static_cast<std::uint64_t>(taken.number() - newest->second - 1);
    newest->second = taken.number();
  }
}

std::uint64_t Reader::lost() {
  const std::uint64_t announced = session_.left ? 0 : not_come();
  const std::lock_guard lock(mutex_);
  const bool silent = std::chrono::steady_clock::now() - come_at_ >= kOnItsWay;
  return lost_ + (silent ? announced : 0);
}

/// Announced after the newest that has come of each writer; those that were announced before we
/// looked for the first time are from before we came.
std::uint64_t Reader::not_come() {
  std::array<dds_instance_handle_t, 32> writers{};
  const dds_return_t count = dds_get_matched_publications(reader_, writers.data(), writers.size());
  std::uint64_t missing = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(std::max(count, 0), writers.size()); ++i) {
    const MatchedWriter endpoint = matched(reader_, writers[i]);
    const std::int64_t announced = endpoint ? newest_announced(type_, &endpoint->key) : 0;
    if (announced != 0 && is_wanted(writers[i])) {
      const std::lock_guard lock(mutex_);
      const auto newest = newest_.try_emplace(writers[i], announced).first;
      missing += static_cast<std::uint64_t>(std::max<std::int64_t>(announced - newest->second, 0));
    }
  }
  return missing;
}

bool Reader::is_wanted(dds_instance_handle_t writer) {
  if (writers_ == Writers::any) {
    return true;
  }
  const std::lock_guard lock(mutex_);
  if (const auto known = wanted_.find(writer); known != wanted_.end()) {
    return known->second;
  }
  const MatchedWriter endpoint = matched(reader_, writer);
  if (!endpoint) {
    return true;  // gone already; rather twice than not at all
  }
  if (wanted_.size() >= kMostKnown) {
    wanted_.clear();
  }
  return wanted_.emplace(writer, !is_reliable(endpoint->qos)).first->second;
}

}  // namespace spikeloop::ros2
