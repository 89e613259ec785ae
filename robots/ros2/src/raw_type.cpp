#include "raw_type.hpp"

#include <dds/ddsi/q_protocol.h>
#include <dds/ddsi/q_radmin.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::ros2 {
namespace {

constexpr std::array<std::byte, kEncodingBytes> kPlainLittleEndian{std::byte{0}, std::byte{1},
                                                                   std::byte{0}, std::byte{0}};

std::size_t filled_up(std::size_t size) {
  return (size + 3) / 4 * 4;
}

const RawData& raw(const ddsi_serdata* data) {
  return *static_cast<const RawData*>(data);
}

/// The sender may have said how many bytes at the end only fill up (XTypes 1.3, 7.6.3.1.2). A size
/// that is not a multiple of four has none of them, as some senders of fragments have it.
void drop_filling(RawData& data) {
  const auto filling = std::to_integer<std::uint32_t>(data.bytes[kEncodingBytes - 1]) & 3U;
  if (data.size % 4 == 0 && data.size >= kEncodingBytes + filling) {
    data.size -= filling;
  }
}

// --- one message
// -----------------------------------------------------------------------------------

/// Messages have no key: there is one instance, and all are of it.
bool same_key(const ddsi_serdata*, const ddsi_serdata*) {
  return true;
}

/// As it leaves: the encoding says how much of it fills up.
std::uint32_t size_of(const ddsi_serdata* data) {
  return static_cast<std::uint32_t>(filled_up(raw(data).size));
}

/// A publisher counts its messages, and every packet says which one it belongs to.
std::int64_t number_of(const nn_rdata& fragment) {
  if (fragment.submsg_zoff == 0) {
    return 0;
  }
  Data_DataFrag_common_t head;
  std::memcpy(&head, NN_RMSG_PAYLOADOFF(fragment.rmsg, NN_RDATA_SUBMSG_OFF(&fragment)),
              sizeof head);
  return (std::int64_t{head.writerSN.high} << 32) + head.writerSN.low;
}

/// Fragments come in the order of their beginnings, may overlap and leave no gap.
ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind,
                             const nn_rdata* fragment, std::size_t size) {
  if (size < kEncodingBytes || fragment == nullptr) {
    return nullptr;
  }
  auto data = std::make_unique<RawData>(type, kind, size);
  data->number = number_of(*fragment);
  std::size_t have = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    const std::size_t end = std::min<std::size_t>(fragment->maxp1, size);
    if (fragment->min > have || end <= have) {
      continue;
    }
    const unsigned char* payload =
        NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(data->bytes.get() + have, payload + (have - fragment->min), end - have);
    have = end;
  }
  if (have != size) {
    return nullptr;
  }
  drop_filling(*data);
  return data.release();
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind,
                          ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* pieces, std::size_t size) {
  if (size < kEncodingBytes) {
    return nullptr;
  }
  auto data = std::make_unique<RawData>(type, kind, size);
  std::size_t have = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && have < size; ++i) {
    const std::size_t part = std::min<std::size_t>(pieces[i].iov_len, size - have);
    std::memcpy(data->bytes.get() + have, pieces[i].iov_base, part);
    have += part;
  }
  if (have != size) {
    return nullptr;
  }
  drop_filling(*data);
  return data.release();
}

/// No fields, but something to send when a writer says that its instance has ended.
std::unique_ptr<RawData> no_fields(const ddsi_sertype* type) {
  auto data = std::make_unique<RawData>(type, SDK_KEY, kEncodingBytes);
  std::copy(kPlainLittleEndian.begin(), kPlainLittleEndian.end(), data->bytes.get());
  return data;
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return no_fields(type).release();
}

/// Only to end an instance: messages themselves go through write_raw().
ddsi_serdata* from_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void*) {
  return kind == SDK_DATA ? nullptr : no_fields(type).release();
}

void copy_part(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* out) {
  std::memcpy(out, raw(data).bytes.get() + offset, size);
}

ddsi_serdata* refer_to_part(const ddsi_serdata* data, std::size_t offset, std::size_t size,
                            ddsrt_iovec_t* part) {
  part->iov_base = raw(data).bytes.get() + offset;
  part->iov_len = size;
  return ddsi_serdata_ref(data);
}

void release_part(ddsi_serdata* data, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(data);
}

/// Samples in a form of C are what this type does without.
bool to_sample(const ddsi_serdata*, void*, void**, void*) {
  return false;
}

bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return false;
}

ddsi_serdata* to_untyped(const ddsi_serdata* data) {
  auto untyped = no_fields(data->type);
  untyped->type = nullptr;
  return untyped.release();
}

void free_data(ddsi_serdata* data) {
  delete static_cast<RawData*>(data);
}

/// For Cyclone's traces.
std::size_t print(const ddsi_sertype*, const ddsi_serdata* data, char* out, std::size_t size) {
  const auto written = fmt::format_to_n(out, size - 1, "{} bytes", raw(data).size);
  *written.out = '\0';
  return written.size;
}

void get_keyhash(const ddsi_serdata*, ddsi_keyhash* out, bool) {
  std::memset(out->value, 0, sizeof out->value);
}

const ddsi_serdata_ops kDataOps = {
    .eqkey = same_key,
    .get_size = size_of,
    .from_ser = from_fragments,
    .from_ser_iov = from_pieces,
    .from_keyhash = from_keyhash,
    .from_sample = from_sample,
    .to_ser = copy_part,
    .to_ser_ref = refer_to_part,
    .to_ser_unref = release_part,
    .to_sample = to_sample,
    .to_untyped = to_untyped,
    .untyped_to_sample = untyped_to_sample,
    .free = free_data,
    .print = print,
    .get_keyhash = get_keyhash,
    .get_sample_size = nullptr,  // of iceoryx's shared memory, which is off
    .from_iox_buffer = nullptr,
};

// --- the type
// --------------------------------------------------------------------------------------

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}

/// Cyclone compares the names before.
bool same_type(const ddsi_sertype*, const ddsi_sertype*) {
  return true;
}

std::uint32_t no_hash(const ddsi_sertype*) {
  return 0;
}

// Without type information: a peer of Fast DDS 3 that has it answers Cyclone's questions about it
// in a form that Cyclone 0.10 does not understand, and no endpoint would match. Then names decide.
const ddsi_sertype_ops kTypeOps = {
    .version = ddsi_sertype_v0,
    .arg = nullptr,
    .free = free_type,
    .zero_samples = nullptr,  // of samples in a form of C, which this type does without
    .realloc_samples = nullptr,
    .free_samples = nullptr,
    .equal = same_type,
    .hash = no_hash,
    .type_id = nullptr,
    .type_map = nullptr,
    .type_info = nullptr,
    .derive_sertype = nullptr,
    .get_serialized_size = nullptr,
    .serialize_into = nullptr,
};

}  // namespace

RawData::RawData(const ddsi_sertype* type_of, ddsi_serdata_kind kind_of, std::size_t message_size)
    : ddsi_serdata{},
      bytes(std::make_unique_for_overwrite<std::byte[]>(filled_up(message_size))),
      size(static_cast<std::uint32_t>(message_size)) {
  ddsi_serdata_init(this, type_of, kind_of);
  hash = type_of->serdata_basehash;
  std::fill(bytes.get() + message_size, bytes.get() + filled_up(message_size), std::byte{0});
}

RawTopic::RawTopic(dds_entity_t participant, const std::string& dds_topic,
                   const std::string& dds_type)
    : name(dds_topic) {
  auto own = std::make_unique<ddsi_sertype>();
  ddsi_sertype_init(own.get(), dds_type.c_str(), &kTypeOps, &kDataOps, true);
  own->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  ddsi_sertype* registered = own.release();
  entity = dds_create_topic_sertype(participant, dds_topic.c_str(), &registered, nullptr, nullptr,
                                    nullptr);
  if (entity < 0) {
    ddsi_sertype_unref(registered);
    throw TransportError(with_code(Code::ros_setting,
                                   "Cyclone DDS refuses the topic '{}' of type {}: {}", dds_topic,
                                   dds_type, dds_strretcode(entity)));
  }
  type = registered;
}

RawTopic::~RawTopic() {
  dds_delete(entity);
}

dds_return_t write_raw(dds_entity_t writer, const RawTopic& topic,
                       std::span<const std::byte> message) {
  auto data = std::make_unique<RawData>(topic.type, SDK_DATA, message.size());
  std::copy(message.begin(), message.end(), data->bytes.get());
  const std::size_t filling = filled_up(message.size()) - message.size();
  data->bytes[kEncodingBytes - 1] = static_cast<std::byte>(filling);
  return dds_writecdr(writer, data.release());
}

TakenMessage::TakenMessage(dds_entity_t reader) {
  ddsi_serdata* data = nullptr;
  if (dds_takecdr(reader, &data, 1, &info_, DDS_ANY_STATE) == 1) {
    data_ = static_cast<const RawData*>(data);
  }
}

TakenMessage::~TakenMessage() {
  if (data_ != nullptr) {
    ddsi_serdata_unref(const_cast<RawData*>(data_));
  }
}

}  // namespace spikeloop::ros2
