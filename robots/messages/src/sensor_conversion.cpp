#include "spikeloop/messages/sensor_conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
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
  if (const auto known = reading->width()) {
    return static_cast<std::uint32_t>(*known);
  }
  reading->take(message);
  return static_cast<std::uint32_t>(reading->values().numbers.size());
}

bool SensorConversion::convert(std::span<const std::byte> message) {
  ++counts_.messages;
  passes_nan_ = false;
  try {
    whole_ = reading_->take(message);
  } catch (const TransportError& error) {
    if (counts_.malformed++ == 0) {
      warn(fmt::format("a {} could not be read and is left out: {}", type_, error.what()));
    }
    return false;
  }
  std::ranges::move(reading_->take_warnings(), std::back_inserter(warnings_));
  bool any = false;
  if (whole_) {
    fit();
    any = take_values();
  }
  counts_.without_reading += any ? 0 : 1;
  any_reading_ = any_reading_ || any;
  if (counts_.messages == kPatientMessages) {
    warn(describe_unread());
  }
  return any;
}

bool SensorConversion::take_values() {
  const ReadValues& values = reading_->values();
  const std::size_t count = std::min(values.numbers.size(), channels_.size());
  bool any = false;
  for (std::size_t i = 0; i < count; ++i) {
    if (values.held[i] != Held::no) {
      counts_.invalid_readings += values.held[i] == Held::no_reading ? 1 : 0;
      continue;
    }
    channels_[i] = values.numbers[i];
    const bool is_nan = std::isnan(values.numbers[i]);
    any = any || !is_nan;
    passes_nan_ = passes_nan_ || is_nan;
  }
  if (!any) {
    warn_of_no_reading();
  }
  return any;
}

void SensorConversion::warn_of_no_reading() {
  if (told_no_reading_ || (passes_nan_ && !any_reading_)) {
    return;  // the first NaN of a sensor that starts is reported if there is no number later
  }
  told_no_reading_ = true;
  told_unread_ = !any_reading_;
  if (any_reading_) {
    warn(fmt::format("a {} brought no reading; the channels {}", type_,
                     passes_nan_ ? "are NaN" : "keep what they had"));
  } else {
    warn(fmt::format("a {} brought no reading in '{}', so the channels have no value", type_,
                     reading_->name_of(0)));
  }
}

std::string SensorConversion::unread() const {
  return counts_.messages < kPatientMessages ? describe_unread() : "";
}

std::string SensorConversion::describe_unread() const {
  if (counts_.messages == counts_.malformed || (told_unread_ && !any_reading_)) {
    return {};
  }
  const ReadValues& values = reading_->values();
  // If `skip` left the newest message out, reading stopped at the first value that is not a number.
  // The warning of a short message names the channels that no message reaches.
  const std::size_t read = values.held.size();
  const std::size_t end = std::min(whole_ ? read : channels_.size(), channels_.size());
  std::size_t first = end;
  std::size_t count = 0;
  for (std::size_t i = 0; i < end; ++i) {
    if (std::isnan(channels_[i]) && count++ == 0) {
      first = i;
    }
  }
  if (count == 0) {
    return {};
  }
  first = whole_ ? first : std::min(read, end - 1);
  const bool missing = first < read && values.held[first] == Held::missing;
  return fmt::format(
             "the first {} had no {}'{}', so {}",
             counts_.messages == 1 ? "message" : fmt::format("{} messages", counts_.messages),
             missing ? "" : "valid value in ", reading_->name_of(first),
             count == 1 ? fmt::format("channel {} has no value", first)
             : whole_
                 ? fmt::format("{} channels have no value, the first is channel {}", count, first)
                 : fmt::format("{} channels have no value", count)) +
         (missing ? "" : reading_->nan_remedy());
}

void SensorConversion::fit() {
  const ReadValues& values = reading_->values();
  Misfit misfit{"", values.numbers.size(), channels_.size()};
  if (misfit.values == misfit.channels && values.misfit) {
    misfit = *values.misfit;
  }
  if (misfit.values == misfit.channels || values.numbers.empty()) {
    return;
  }
  const std::string difference =
      misfit.path.empty()
          ? fmt::format("a {} brought {} values, but the port has {} channels", type_,
                        misfit.values, misfit.channels)
          : fmt::format("a {} brought {} values in '{}', but {} of the channels are for them",
                        type_, misfit.values, misfit.path, misfit.channels);
  const std::size_t whole = channels_.size() - misfit.channels + misfit.values;
  if (strict_) {
    throw ConfigurationError(
        with_code(Code::fields_differ, "{}; write [{}] in its connection", difference, whole));
  }
  const bool surplus = misfit.values > misfit.channels;
  if (counts_.cropped + counts_.short_messages == 0) {
    const std::string remedy = reading_->length_remedy(channels_.size());
    warn(fmt::format(
        "{}: surplus values are left out, and channels without a value keep their last one; "
        "{}write [{}] in its connection {}",
        difference, remedy.empty() ? "" : remedy + ", or ", whole,
        surplus ? "to have all" : "if no message has more"));
  }
  ++(surplus ? counts_.cropped : counts_.short_messages);
}

void SensorConversion::warn(std::string text) {
  if (!text.empty()) {
    warnings_.push_back(std::move(text));
  }
}

std::string SensorConversion::take_warning() {
  if (warnings_.empty()) {
    return {};
  }
  std::string first = std::move(warnings_.front());
  warnings_.erase(warnings_.begin());
  return first;
}

}  // namespace spikeloop::messages
