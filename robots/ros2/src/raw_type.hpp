// Messages as bytes in Cyclone DDS: a type of DDS that is but a name, so that no code is generated
// for any message.
#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace spikeloop::ros2 {

/// What stands before the fields of every message, and says how they are encoded.
constexpr std::size_t kEncodingBytes = 4;

/// One message with its encoding.
struct RawData : ddsi_serdata {
  /// @param message_size at least kEncodingBytes; the bytes are the caller's to fill in
  RawData(const ddsi_sertype* type_of, ddsi_serdata_kind kind_of, std::size_t message_size);

  std::span<const std::byte> message() const { return {bytes.get(), size}; }

  std::unique_ptr<std::byte[]> bytes;  ///< up to the next multiple of four, as RTPS sends them
  std::uint32_t size;                  ///< without those that fill up
  std::int64_t number = 0;             ///< its writer's, from 1; 0: not known
};

/// A topic of DDS whose messages are RawData.
struct RawTopic {
  std::string name;  ///< "rt/scan"
  dds_entity_t entity = 0;
  const ddsi_sertype* type = nullptr;  ///< lives as long as the topic

  /// @throws TransportError when Cyclone DDS refuses it.
  RawTopic(dds_entity_t participant, const std::string& dds_topic, const std::string& dds_type);
  ~RawTopic();
  RawTopic(const RawTopic&) = delete;
  RawTopic& operator=(const RawTopic&) = delete;
};

/// Writes one message. @return what dds_writecdr says
dds_return_t write_raw(dds_entity_t writer, const RawTopic& topic,
                       std::span<const std::byte> message);

/// Takes the oldest message of a reader, or none; messages that only say that a writer ended are
/// none.
class TakenMessage {
 public:
  explicit TakenMessage(dds_entity_t reader);
  ~TakenMessage();
  TakenMessage(const TakenMessage&) = delete;
  TakenMessage& operator=(const TakenMessage&) = delete;

  bool any() const { return data_ != nullptr; }             ///< something was there
  bool valid() const { return any() && info_.valid_data; }  ///< and it is a message
  std::span<const std::byte> message() const { return data_->message(); }
  dds_instance_handle_t writer() const { return info_.publication_handle; }
  std::int64_t number() const { return data_->number; }  ///< as RawData has it

 private:
  const RawData* data_ = nullptr;
  dds_sample_info_t info_{};
};

}  // namespace spikeloop::ros2
