#include "reader.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include "inside.h"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::ros2 {
namespace {

/// Of one topic at a time, so that a busy one does not hold up the others.
constexpr int kMostAtOnce = 16;

/// Cyclone DDS tells of a writer a moment before it connects it.
constexpr std::chrono::microseconds kLook{100};
constexpr int kMostLooks = 100;

}  // namespace

Reader::Reader(Session::Impl& session, const RawTopic& topic, const Qos& qos, Take take)
    : session_(session),
      type_(topic.type),
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
    if (taken.valid()) {
      take_(taken);
    }
  }
}

}  // namespace spikeloop::ros2
