#include "qos.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "spikeloop/core/time.hpp"

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

namespace {

bool is_exclusive(const dds_qos_t* qos) {
  dds_ownership_kind_t kind = DDS_OWNERSHIP_SHARED;
  return dds_qget_ownership(qos, &kind) && kind == DDS_OWNERSHIP_EXCLUSIVE;
}

/// XCDR2 and no XCDR1. An empty list is XCDR1.
bool lacks_xcdr1(const dds_qos_t* qos) {
  std::uint32_t count = 0;
  dds_data_representation_id_t* values = nullptr;
  if (!dds_qget_data_representation(qos, &count, &values)) {
    return false;
  }
  const bool lacks = count > 0 && std::find(values, values + count,
                                            DDS_DATA_REPRESENTATION_XCDR1) == values + count;
  dds_free(values);
  return lacks;
}

std::string list(const std::vector<std::string>& parts) {
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace

Requests requests_of(const dds_qos_t* qos) {
  Requests requests;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  if (dds_qget_durability(qos, &durability) && durability != DDS_DURABILITY_VOLATILE) {
    requests.late = "durability transient local, but Spikeloop's publisher is volatile";
  }
  std::vector<std::string> others;
  if (durability > DDS_DURABILITY_TRANSIENT_LOCAL) {
    requests.late.clear();
    others.emplace_back(
        "durability transient or persistent, but Spikeloop's publisher is volatile or transient "
        "local");
  }
  dds_duration_t time = DDS_INFINITY;
  if (dds_qget_deadline(qos, &time) && time != DDS_INFINITY) {
    others.push_back(
        fmt::format("a deadline of {}, but Spikeloop's publisher has none", format_time(time)));
  }
  dds_liveliness_kind_t liveliness = DDS_LIVELINESS_AUTOMATIC;
  if (dds_qget_liveliness(qos, &liveliness, &time)) {
    if (liveliness != DDS_LIVELINESS_AUTOMATIC) {
      others.emplace_back("liveliness by topic, but that of Spikeloop's publisher is automatic");
    }
    if (time != DDS_INFINITY) {
      others.push_back(fmt::format("a liveliness lease of {}, but Spikeloop's publisher has none",
                                   format_time(time)));
    }
  }
  if (is_exclusive(qos)) {
    others.emplace_back("exclusive ownership, but that of Spikeloop's publisher is shared");
  }
  if (lacks_xcdr1(qos)) {
    others.emplace_back("the encoding XCDR2, but Spikeloop's publisher sends XCDR1");
  }
  requests.other = list(others);
  return requests;
}

std::string offer_misfit(const dds_qos_t* qos) {
  std::vector<std::string> parts;
  if (is_exclusive(qos)) {
    parts.emplace_back("exclusive ownership, but ROS 2 uses shared ownership");
  }
  if (lacks_xcdr1(qos)) {
    parts.emplace_back("the encoding XCDR2, but ROS 2 uses XCDR1");
  }
  return list(parts);
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
