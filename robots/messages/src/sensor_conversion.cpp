#include "spikeloop/messages/sensor_conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "reading.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

/// Those who publish parts of a topic's elements in turn have all been heard by then.
constexpr std::uint64_t kPatientMessages = 20;

}  // namespace

SensorConversion::SensorConversion(const Catalog& catalog, std::string_view type,
                                   const SensorRule& rule, std::uint32_t width, bool strict)
    : type_(catalog.full_name(type)),
      strict_(strict),
      reading_(make_reading(catalog, type_, rule, width)),
      channels_(width, std::numeric_limits<double>::quiet_NaN()) {
  const std::optional<std::size_t> known = reading_->width();
  if (strict && known && *known != width) {
    throw ConfigurationError(with_code(Code::fields_differ,
                                       "a {} gives {} values, but the port has {} channels; write "
                                       "[{}] in its connection",
                                       type_, *known, width, *known));
  }
}

SensorConversion::~SensorConversion() = default;
SensorConversion::SensorConversion(SensorConversion&&) noexcept = default;

std::uint32_t SensorConversion::count(const Catalog& catalog, std::string_view type,
                                      const SensorRule& rule, std::span<const std::byte> message) {
  const auto reading = make_reading(catalog, catalog.full_name(type), rule, 0);
  reading->take(message);
  return static_cast<std::uint32_t>(reading->values().numbers.size());
}

bool SensorConversion::convert(std::span<const std::byte> message) {
  ++counts_.messages;
  bool whole = false;
  try {
    whole = reading_->take(message);
  } catch (const TransportError& error) {
    if (counts_.malformed++ == 0) {
      warning_ = fmt::format("a {} could not be read and is left out: {}", type_, error.what());
    }
    return false;
  }
  if (!whole) {
    ++counts_.without_reading;
    return false;
  }
  fit(reading_->values().numbers.size());
  return take_values();
}

bool SensorConversion::take_values() {
  const ReadValues& values = reading_->values();
  const std::size_t count = std::min(values.numbers.size(), channels_.size());
  std::size_t readings = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (values.held[i] != Held::no) {
      counts_.invalid_readings += values.held[i] == Held::no_reading ? 1 : 0;
    } else {
      channels_[i] = values.numbers[i];
      ++readings;
    }
  }
  if (counts_.messages == kPatientMessages) {
    warn_of_missing();
  }
  if (readings == 0 && counts_.without_reading++ == 0) {
    warning_ = fmt::format("a {} brought no reading; the channels keep what they had", type_);
  }
  return readings > 0;
}

void SensorConversion::warn_of_missing() {
  const ReadValues& values = reading_->values();
  for (std::size_t i = 0; i < std::min(values.held.size(), channels_.size()); ++i) {
    if (values.held[i] == Held::missing && std::isnan(channels_[i])) {
      warning_ = fmt::format("the first {} messages had no '{}', so channel {} has no value",
                             kPatientMessages, reading_->path_of(i), i);
      return;
    }
  }
}

void SensorConversion::fit(std::size_t count) {
  const std::size_t width = channels_.size();
  if (count == width || count == 0) {
    return;
  }
  if (strict_) {
    throw ConfigurationError(
        with_code(Code::fields_differ,
                  "a {} brought {} values, but the port has {} channels; write [{}] in its "
                  "connection",
                  type_, count, width, count));
  }
  if (count > width) {
    if (counts_.cropped++ == 0) {
      warning_ = fmt::format(
          "a {} brought {} values, but the port has {} channels: the last {} are "
          "left out; write [{}] in its connection to have all",
          type_, count, width, count - width, count);
    }
  } else if (counts_.short_messages++ == 0) {
    warning_ = fmt::format(
        "a {} brought {} values, but the port has {} channels: the last {} keep "
        "their value; write [{}] in its connection",
        type_, count, width, width - count, count);
  }
}

std::string SensorConversion::take_warning() {
  return std::exchange(warning_, {});
}

}  // namespace spikeloop::messages
