#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "spikeloop/messages/event_array.hpp"
#include "spikeloop/messages/event_decoder.hpp"

namespace spikeloop::messages {
namespace {

constexpr std::string_view kEventArray = "dvs_msgs/EventArray";
constexpr const char* kPolarityNames[] = {"both", "on", "off", "split"};
constexpr TimeNs kBeforeAll = std::numeric_limits<TimeNs>::min();

std::uint32_t blocks(std::uint32_t pixels, std::uint32_t factor) {
  return (pixels + factor - 1) / factor;
}

/// For pixels from 0 to `all`: `stride` times the block of those in [begin, begin + count), else
/// -1.
std::vector<std::int32_t> block_table(std::uint32_t all, std::uint32_t begin, std::uint32_t count,
                                      std::uint32_t factor, std::uint32_t stride) {
  std::vector<std::int32_t> table(all, -1);
  for (std::uint32_t i = 0; i < count; ++i) {
    table[begin + i] = static_cast<std::int32_t>(i / factor * stride);
  }
  return table;
}

}  // namespace

Polarity polarity_named(std::string_view name) {
  const auto* const found = std::ranges::find(kPolarityNames, name);
  if (found == std::end(kPolarityNames)) {
    throw std::logic_error(fmt::format("'{}' is not a polarity", name));
  }
  return static_cast<Polarity>(found - std::begin(kPolarityNames));
}

const char* name_of(Polarity polarity) {
  return kPolarityNames[static_cast<std::size_t>(polarity)];
}

void check_event_type(const std::string& message_type) {
  if (message_type != kEventArray && message_type != kEventPacket) {
    throw ConfigurationError(with_code(
        Code::field_path, "message type '{}' has no events of a camera{}", message_type,
        did_you_mean(message_type, {std::string(kEventArray), std::string(kEventPacket)})));
  }
}

std::uint64_t event_channels(const EventSettings& settings, std::uint32_t width,
                             std::uint32_t height) {
  const Region region = settings.region.value_or(Region{0, 0, width, height});
  return (settings.polarity == Polarity::split ? 2ull : 1ull) *
         blocks(region.width, settings.downsample) * blocks(region.height, settings.downsample);
}

std::uint64_t event_channels(const EventSettings& settings, Dialect dialect,
                             std::span<const std::byte> message) {
  if (settings.message_type == kEventPacket) {
    const EventPacket packet = read_event_packet(dialect, message);
    return event_channels(settings, packet.width, packet.height);
  }
  const EventArray array(message, dialect);
  return event_channels(settings, array.width(), array.height());
}

EventConversion::EventConversion(const EventSettings& settings, Dialect dialect)
    : settings_(settings), dialect_(dialect) {
  located_at(settings_.where, [&] { check_event_type(settings_.message_type); });
  if (settings_.region) {
    check_width("a region", settings_.region->width, settings_.region->height);
  }
  if (settings_.refractory > 0) {
    last_.assign(settings_.width, kBeforeAll);
  }
}

void EventConversion::check_width(std::string_view what, std::uint32_t width,
                                  std::uint32_t height) const {
  const std::uint64_t channels = event_channels(settings_, width, height);
  if (channels != settings_.width) {
    throw ConfigurationError(
        settings_.where,
        with_code(Code::fields_differ,
                  "{} of {} x {} pixels makes {} channels (polarity={}, downsample={}), but the "
                  "port has {}; write [{}] in its connection",
                  what, width, height, channels, name_of(settings_.polarity), settings_.downsample,
                  settings_.width, channels));
  }
}

void EventConversion::fit(std::uint32_t width, std::uint32_t height) {
  if (width == camera_width_ && height == camera_height_) {
    return;
  }
  const Region region = settings_.region.value_or(Region{0, 0, width, height});
  if (std::uint64_t{region.x} + region.width > width ||
      std::uint64_t{region.y} + region.height > height) {
    throw ConfigurationError(
        settings_.where,
        with_code(Code::out_of_bounds,
                  "roi={},{},{},{} reaches beyond the camera, which has {} x {} pixels; write a "
                  "region within it",
                  region.x, region.y, region.width, region.height, width, height));
  }
  check_width(settings_.region ? "a region" : "a camera", region.width, region.height);
  camera_width_ = width;
  camera_height_ = height;
  const std::uint32_t columns = blocks(region.width, settings_.downsample);
  column_of_ = block_table(width, region.x, region.width, settings_.downsample, 1);
  row_of_ = block_table(height, region.y, region.height, settings_.downsample, columns);
  const Polarity polarity = settings_.polarity;
  first_of_polarity_[1] = polarity == Polarity::off ? -1 : 0;
  first_of_polarity_[0] = polarity == Polarity::on ? -1 : 0;
  if (polarity == Polarity::split) {
    first_of_polarity_[0] = static_cast<std::int32_t>(settings_.width / 2);
  }
}

void EventConversion::restart() {
  decoder_ = {};
  std::ranges::fill(last_, kBeforeAll);
}

/// Sensor clocks jump back when a recording begins again: an event before the last one is none that
/// is too soon.
bool EventConversion::rests(const Spike& event) {
  TimeNs& last = last_[static_cast<std::size_t>(event.channel)];
  const bool early =
      event.time_ns >= last && last != kBeforeAll && event.time_ns - last < settings_.refractory;
  if (!early) {
    last = event.time_ns;
  }
  return early;
}

bool EventConversion::convert(std::span<const std::byte> bytes, EventMessage& message) {
  ++counts_.messages;
  message.events.clear();
  message.newest.reset();
  std::optional<EventArray> array;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  try {
    if (settings_.message_type == kEventPacket) {
      const EventPacket packet = read_event_packet(dialect_, bytes);
      decoder_.decode(packet, decoded_);
      width = packet.width;
      height = packet.height;
    } else {
      array.emplace(bytes, dialect_);
      width = array->width();
      height = array->height();
    }
  } catch (const TransportError& error) {
    if (counts_.malformed++ == 0) {
      warning_ = fmt::format("a {} could not be read and is left out: {}", settings_.message_type,
                             error.what());
    }
    return false;
  }
  fit(width, height);
  if (array) {
    take(*array, message);
  } else {
    take(decoded_, message);
  }
  return true;
}

template <typename Events>
void EventConversion::take(const Events& events, EventMessage& message) {
  counts_.events += events.size();
  message.events.reserve(events.size());
  TimeNs newest = kBeforeAll;
  std::uint64_t outside = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const CameraEvent event = events[i];
    newest = std::max(newest, event.stamp);
    if (event.x >= camera_width_ || event.y >= camera_height_) {
      ++outside;
      continue;
    }
    const std::int32_t column = column_of_[event.x];
    const std::int32_t row = row_of_[event.y];
    const std::int32_t first = first_of_polarity_[event.on ? 1 : 0];
    if ((column | row | first) < 0) {
      ++counts_.left_out;
      continue;
    }
    const Spike spike = make_spike(event.stamp, first + row + column);
    if (!last_.empty() && rests(spike)) {
      ++counts_.refractory;
      continue;
    }
    message.events.push_back(spike);
  }
  if (outside != 0 && counts_.outside_camera == 0) {
    warning_ = fmt::format(
        "{} events of a message lie outside the {} x {} pixels that it says its camera has; they "
        "are left out",
        outside, camera_width_, camera_height_);
  }
  counts_.outside_camera += outside;
  if (newest != kBeforeAll) {
    message.newest = newest;
  }
}

std::string EventConversion::take_warning() {
  return std::exchange(warning_, {});
}

}  // namespace spikeloop::messages
