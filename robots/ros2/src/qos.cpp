#include "qos.hpp"

#include <algorithm>
#include <limits>

namespace spikeloop::ros2 {
namespace {

/// How long a write may take when even the writer's whole gigabyte waits for subscribers.
constexpr dds_duration_t kLongestWrite = DDS_MSECS(100);

/// Messages are XCDR1 and nothing else; ROS 2 says so, too.
Qos endpoint_qos(const std::string& user_data) {
  Qos qos = user_data_qos(user_data);
  const dds_data_representation_id_t plain = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &plain);
  return qos;
}

std::int32_t depth(std::uint32_t queue) {
  return static_cast<std::int32_t>(
      std::min<std::uint32_t>(queue, std::numeric_limits<std::int32_t>::max()));
}

void set_history(dds_qos_t* qos, std::uint32_t queue) {
  if (queue == 0) {
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  } else {
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth(queue));
  }
}

}  // namespace

Qos user_data_qos(const std::string& user_data) {
  Qos qos(dds_create_qos());
  if (!user_data.empty()) {
    dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  }
  return qos;
}

Qos writer_qos(std::uint32_t queue, bool latched, const std::string& user_data) {
  Qos qos = endpoint_qos(user_data);
  set_history(qos.get(), queue);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, kLongestWrite);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  dds_qset_durability(qos.get(),
                      latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (latched) {
    const auto kind = queue == 0 ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST;
    const std::int32_t kept = queue == 0 ? DDS_LENGTH_UNLIMITED : depth(queue);
    dds_qset_durability_service(qos.get(), 0, kind, kept, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

Qos reader_qos(std::uint32_t queue, bool reliable, bool latched, const std::string& user_data) {
  Qos qos = endpoint_qos(user_data);
  set_history(qos.get(), queue);
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       0);
  dds_qset_durability(qos.get(),
                      latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  return qos;
}

bool is_reliable(const dds_qos_t* qos) {
  dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
  dds_duration_t blocking = 0;
  return dds_qget_reliability(qos, &kind, &blocking) && kind == DDS_RELIABILITY_RELIABLE;
}

bool is_latched(const dds_qos_t* qos) {
  dds_durability_kind_t kind = DDS_DURABILITY_VOLATILE;
  return is_reliable(qos) && dds_qget_durability(qos, &kind) && kind != DDS_DURABILITY_VOLATILE;
}

}  // namespace spikeloop::ros2
