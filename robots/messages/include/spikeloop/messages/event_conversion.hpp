// From an event camera's messages to the channels of a port.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/signal.hpp"
#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/messages/event_decoder.hpp"

namespace spikeloop::messages {

/// Which events are taken. `split` gives the brighter and the darker ones channels of their own.
enum class Polarity : std::uint8_t { both, on, off, split };

/// @throws std::logic_error for another word.
Polarity polarity_named(std::string_view name);
const char* name_of(Polarity polarity);

/// A part of the camera, in pixels.
struct Region {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

/// @throws ConfigurationError when no events of a camera come in such messages.
void check_event_type(const std::string& message_type);

struct EventSettings {
  /// dvs_msgs/EventArray or event_camera_msgs/EventPacket.
  std::string message_type = "dvs_msgs/EventArray";
  Polarity polarity = Polarity::both;
  std::uint32_t downsample = 1;    ///< blocks of so many pixels in x and y share a channel
  std::optional<Region> region{};  ///< before down-sampling; none: the whole camera
  TimeNs refractory = 0;           ///< a channel's events so soon after the last one are left out
  std::uint32_t width = 0;         ///< of the port
  Location where{};                ///< of the port, for messages
};

/// The channels that a camera of so many pixels takes, or its region.
std::uint64_t event_channels(const EventSettings& settings, std::uint32_t width,
                             std::uint32_t height);
/// Those that the camera of this message takes. @throws TransportError when it cannot be read.
std::uint64_t event_channels(const EventSettings& settings, Dialect dialect,
                             std::span<const std::byte> message);

/// The events of one message: sensor stamps and channels, as they came.
struct EventMessage {
  std::vector<Spike> events;
  /// The latest stamp of any of its events, also of those that were left out; none: it had none.
  std::optional<TimeNs> newest;
};

/// A region of w x h pixels becomes W x H = ceil(w / downsample) x ceil(h / downsample) channels:
/// those at the right and lower rim may have fewer pixels, so that no event is lost. Pixel (x, y)
/// of the region is channel
///
///     y' * W + x'        with x' = floor(x / downsample), y' = floor(y / downsample),
///
/// and with `split`, darker ones are H * W + y' * W + x'.
class EventConversion {
 public:
  struct Counts {
    std::uint64_t messages = 0;
    std::uint64_t events = 0;          ///< all that the messages had
    std::uint64_t left_out = 0;        ///< of these, outside the region or of the other polarity
    std::uint64_t refractory = 0;      ///< too soon after the channel's last one
    std::uint64_t outside_camera = 0;  ///< at a pixel that the camera does not have
    std::uint64_t malformed = 0;       ///< messages that could not be read
  };

  /// @throws ConfigurationError: another type of message; as convert(), as far as the region says
  /// it already.
  EventConversion(const EventSettings& settings, Dialect dialect);

  /// Replaces `message`. False: the bytes are malformed, and it is empty.
  /// @throws ConfigurationError with both sizes when the camera does not fit the port or the region
  /// does not lie in the camera.
  bool convert(std::span<const std::byte> bytes, EventMessage& message);

  /// From here on as if no message had come before; the counts go on.
  void restart();

  const Counts& counts() const { return counts_; }
  /// What the last convert() found worth telling, once a kind; else empty.
  std::string take_warning();

 private:
  void check_width(std::string_view what, std::uint32_t width, std::uint32_t height) const;
  void fit(std::uint32_t width, std::uint32_t height);
  bool rests(const Spike& event);
  /// Events is an EventArray, or a vector of CameraEvent.
  template <typename Events>
  void take(const Events& events, EventMessage& message);

  EventSettings settings_;
  Dialect dialect_;
  std::uint32_t camera_width_ = 0;  ///< that the tables below are for
  std::uint32_t camera_height_ = 0;
  std::vector<std::int32_t> column_of_;  ///< of a pixel's x; negative: left out
  std::vector<std::int32_t> row_of_;     ///< of its y: the first channel of the row
  std::int32_t first_of_polarity_[2]{};  ///< off, on: the first channel; negative: left out
  EventDecoder decoder_;
  std::vector<CameraEvent> decoded_;
  std::vector<TimeNs> last_;  ///< of each channel, when there is a refractory period
  Counts counts_;
  std::string warning_;
};

}  // namespace spikeloop::messages
