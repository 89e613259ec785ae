// The packed events of event_camera_msgs/EventPacket.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "spikeloop/messages/event_array.hpp"

namespace spikeloop::messages {

/// What one packet brings, beside its header's stamp. A view of a message's bytes.
struct EventPacket {
  std::uint32_t height = 0;  ///< pixels of the camera
  std::uint32_t width = 0;
  std::uint64_t sequence = 0;   ///< one more than that of the packet before
  std::uint64_t time_base = 0;  ///< nanoseconds, of `mono`
  std::string_view encoding{};
  bool big_endian = false;
  std::span<const std::byte> events{};
};

inline constexpr std::string_view kEventPacket = "event_camera_msgs/EventPacket";

/// Returns a view of the message's bytes. @throws TransportError if the message is too short.
EventPacket read_event_packet(Dialect dialect, std::span<const std::byte> message);

/// Decodes packet after packet of one camera.
///
/// - `mono` (event_camera_msgs): 64 bits an event; nanoseconds since time_base in bits 0 to 31, x
/// in
///   32 to 47, y in 48 to 62, brighter in 63.
/// - `evt2` (Prophesee's EVT 2.0): words of 32 bits, of which the highest 4 say what they are: an
///   event with x, y and the lower 6 bits of the time in microseconds, or the upper 28 bits of the
///   times to come. As with evt3, the time is continued beyond its 34 bits (4.8 h), and nothing is
///   decoded before a time has come.
/// - `evt3` (Prophesee's EVT 3.0): words of 16 bits, of which the highest 4 say what the others
///   change: the time in microseconds (24 bits in two halves), y, x of an event, or x and polarity
///   of a vector whose bits are 12 or 8 pixels. What a packet does not say holds from the one
///   before. The time is continued beyond its 24 bits (16.8 s): a step of its upper half is taken
///   to be less than half a turn. Nothing is decoded before a time and a row have come; nor after a
///   packet was lost, until they have come again. Triggers and words of other use are passed over.
class EventDecoder {
 public:
  /// Replaces `events`; their order is the packet's, and stamps are the sensor's.
  /// @throws ConfigurationError for another encoding. TransportError for a broken word, a camera
  /// without pixels or with more than the encoding can name; nothing is kept of such a packet, and
  /// the next one is taken as after a loss.
  void decode(const EventPacket& packet, std::vector<CameraEvent>& events);

 private:
  void decode_mono(const EventPacket& packet, std::vector<CameraEvent>& events) const;
  void decode_evt2(const EventPacket& packet, std::vector<CameraEvent>& events);
  void decode_evt3(const EventPacket& packet, std::vector<CameraEvent>& events);
  void take_vector(std::uint32_t bits, std::uint32_t count, std::vector<CameraEvent>& events);
  void take_upper_time(std::uint32_t upper, std::uint32_t turn);
  void forget();
  TimeNs time() const;

  std::optional<std::uint64_t> next_sequence_;
  bool evt2_ = false;        ///< what the state is of
  std::int64_t turns_ = 0;   ///< of the 24 bits, or 34
  std::uint32_t upper_ = 0;  ///< the upper 12 of them, or 28
  std::uint32_t lower_ = 0;  ///< the lower 12
  std::uint32_t row_ = 0;
  std::uint32_t column_ = 0;  ///< where the next vector begins
  bool on_ = false;           ///< of vectors
  bool upper_known_ = false;  ///< it has come since the last loss, as have the others
  bool time_known_ = false;   ///< both halves
  bool row_known_ = false;
  bool column_known_ = false;
};

}  // namespace spikeloop::messages
