#include "publisher.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "inside.h"
#include "qos.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"

namespace spikeloop::ros2 {
namespace {

/// A subscriber that is stopped never acknowledges; what it missed is with the system by then.
constexpr dds_duration_t kLongestDrain = DDS_MSECS(100);

}  // namespace

Publisher::Publisher(Session::Impl& session, const Endpoint& endpoint, std::uint32_t queue,
                     bool latched)
    : session_(session),
      topic_name_(endpoint.topic),
      dds_type_(endpoint.dds_type_name()),
      latched_(latched),
      topic_(session.participant.entity(), endpoint.dds_name(), endpoint.dds_type_name()),
      writer_(dds_create_writer(session.participant.entity(), topic_.entity,
                                writer_qos(queue, latched, endpoint.user_data).get(), nullptr)) {
  if (writer_ < 0) {
    throw TransportError(with_code(Code::ros_setting, "Cyclone DDS makes no writer of '{}': {}",
                                   topic_name_, dds_strretcode(writer_)));
  }
  session_.nodes.add_writer(writer_);
}

Publisher::~Publisher() {
  session_.nodes.remove(writer_);
  dds_delete(writer_);
}

void Publisher::publish(std::span<const std::byte> message) {
  if (message.size() < kEncodingBytes) {
    throw std::logic_error(
        fmt::format("a message of ROS 2 begins with four bytes; {} came for '{}'", message.size(),
                    topic_name_));
  }
  if (session_.left) {
    return;
  }
  const dds_return_t written = write_raw(writer_, topic_, message);
  if (written < 0 && !complained_.exchange(true)) {
    log::warning("a message on '{}' was not sent: {}; this is said once", topic_name_,
                 dds_strretcode(written));
  }
}

bool Publisher::has_subscribers() const {
  dds_publication_matched_status_t status{};
  return dds_get_publication_matched_status(writer_, &status) == DDS_RETCODE_OK &&
         status.current_count > 0;
}

std::string Publisher::misfit() const {
  for (const OtherReader& reader : session_.graph.readers(topic_.name)) {
    if (reader.type != dds_type_) {
      continue;
    }
    if (!latched_ && !reader.requests.late.empty()) {
      return reader.requests.late;
    }
    if (!reader.requests.other.empty()) {
      return reader.requests.other;
    }
  }
  return {};
}

// Cyclone writes to the socket within publish(); what is left to wait for is that reliable
// subscribers have it, lest something was lost on the way.
bool Publisher::deliver() const {
  dds_guid_t own{};
  dds_get_guid(writer_, &own);
  if (!session_.left) {
    request_acknowledgements(topic_.type, &own);
  }
  return dds_wait_for_acks(writer_, kLongestDrain) != DDS_RETCODE_TIMEOUT;
}

}  // namespace spikeloop::ros2
