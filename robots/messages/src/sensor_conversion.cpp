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

const char* plural(std::size_t count) {
  return count == 1 ? "" : "s";
}

}  // namespace

SensorConversion::SensorConversion(const Catalog& catalog, std::string_view type,
                                   const SensorRule& rule, std::uint32_t width, bool strict,
                                   std::optional<double> initial)
    : type_(catalog.full_name(type)),
      strict_(strict),
      reading_(make_reading(catalog, type_, rule, width)),
      initial_(initial),
      channels_(width, initial.value_or(std::numeric_limits<double>::quiet_NaN())),
      seen_(width, Seen::nothing) {
  const std::optional<std::size_t> known = this->width();
  if (strict && known && *known != width) {
    throw ConfigurationError(with_code(Code::fields_differ,
                                       "a {} gives {} values, but the port has {} channels; write "
                                       "[{}] in its connection",
                                       type_, *known, width, *known));
  }
}

SensorConversion::~SensorConversion() = default;
SensorConversion::SensorConversion(SensorConversion&&) noexcept = default;

std::optional<std::size_t> SensorConversion::width() const {
  return reading_->width();
}

std::string SensorConversion::length_remedy() const {
  return reading_->length_remedy(channels_.size());
}

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
  any_whole_ = any_whole_ || whole_;
  const bool is_cropped = whole_ && fit();
  const bool any = take_values();
  if (whole_ && !any && !is_cropped) {
    warn_of_no_reading(message);
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
  most_values_ = std::max(most_values_, values.numbers.size());
  bool any = false;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_nan = std::isnan(values.numbers[i]);
    if (values.held[i] == Held::missing) {
      continue;
    }
    seen_[i] = std::max(seen_[i], is_nan ? Seen::no_reading : Seen::value);
    if (!whole_) {
      continue;
    }
    if (values.held[i] == Held::no_reading) {
      ++counts_.invalid_readings;
    } else if (!is_nan) {
      channels_[i] = values.numbers[i];
      any = true;
    } else if (seen_[i] == Seen::value || !initial_) {
      channels_[i] = values.numbers[i];
      passes_nan_ = true;
    }
  }
  return any;
}

void SensorConversion::warn_of_no_reading(std::span<const std::byte> message) {
  const bool is_nan = reading_->values().held.end() !=
                      std::ranges::find(reading_->values().held, Held::no);  // passed on
  if (warned_of_no_reading_ || (is_nan && !any_reading_)) {
    return;  // the first NaN of a sensor that starts is reported if there is no number later
  }
  warned_of_no_reading_ = true;
  warned_of_unread_ = !any_reading_;
  if (any_reading_) {
    warn(fmt::format("a {} brought no reading; the channels {}", type_,
                     passes_nan_ ? "are NaN" : "keep what they had"));
  } else {
    const std::vector<Held>& held = reading_->values().held;
    const bool is_missing = !held.empty() && held.front() == Held::missing;
    const std::string names = is_missing ? reading_->names_in(message) : "";
    const std::size_t last = channels_.size() - 1;
    warn(fmt::format(
        "a {} brought no reading in '{}'{}{}, so the channels {}", type_, reading_->name_of(0),
        last == 0 ? "" : fmt::format(" to '{}'", reading_->name_of(last)),
        names.empty() ? "" : fmt::format(", but has the names {}", names),
        initial_ ? fmt::format("keep their initial value {:g}", *initial_) : "have no value"));
  }
}

std::string SensorConversion::unread() const {
  return counts_.messages < kPatientMessages ? describe_unread() : "";
}

std::string SensorConversion::describe_unread() const {
  if (counts_.messages == counts_.malformed || (warned_of_unread_ && !any_reading_)) {
    return {};
  }
  const std::string messages =
      counts_.messages == 1 ? "message" : fmt::format("{} messages", counts_.messages);
  // The warning of a short message names the channels that no message reaches.
  const auto end =
      seen_.begin() + static_cast<std::ptrdiff_t>(std::min(most_values_, seen_.size()));
  const auto is_unread = [](Seen seen) { return seen != Seen::value; };
  const auto unread = std::find_if(seen_.begin(), end, is_unread);
  if (unread == end) {
    return any_whole_ ? ""
                      : fmt::format(
                            "the first {} were left out, because each had NaN in a field "
                            "with nan: skip; replace NaN, as in nan: 0",
                            messages);
  }
  const auto first = static_cast<std::size_t>(unread - seen_.begin());
  const auto count =
      any_whole_ ? static_cast<std::size_t>(std::count_if(unread, end, is_unread)) : seen_.size();
  const bool missing = *unread == Seen::nothing;
  const std::string value = initial_ ? fmt::format("initial value {:g}", *initial_) : "";
  const std::string effect =
      count == 1
          ? fmt::format("channel {} {}", first, initial_ ? "keeps its " + value : "has no value")
          : fmt::format("{} channels {}{}", count,
                        initial_ ? "keep their " + value : "have no value",
                        any_whole_ ? fmt::format(", the first is channel {}", first) : "");
  return fmt::format("the first {} had no {}'{}', so {}{}", messages,
                     missing ? "" : "valid value in ", reading_->name_of(first), effect,
                     initial_ ? "" : "; " + reading_->no_value_remedy(missing, first));
}

bool SensorConversion::fit() {
  const ReadValues& values = reading_->values();
  Misfit misfit{"", values.numbers.size(), channels_.size(), values.numbers.size()};
  if (misfit.values == misfit.channels && values.misfit) {
    misfit = *values.misfit;
  }
  if (misfit.values == misfit.channels || values.numbers.empty()) {
    return false;
  }
  const std::string difference =
      misfit.path.empty()
          ? fmt::format("a {} brought {} value{}, but the port has {} channel{}", type_,
                        misfit.values, plural(misfit.values), misfit.channels,
                        plural(misfit.channels))
          : fmt::format("a {} brought {} values in '{}', but {} of the channels are for them",
                        type_, misfit.values, misfit.path, misfit.channels);
  if (strict_) {
    const std::string remedy = length_remedy();
    throw ConfigurationError(with_code(Code::fields_differ, "{}; write [{}] in its connection{}",
                                       difference, misfit.whole,
                                       remedy.empty() ? "" : ", or " + remedy));
  }
  const bool surplus = misfit.values > misfit.channels;
  if (counts_.cropped + counts_.short_messages == 0) {
    warn_of_length(difference, misfit.whole, surplus);
  }
  ++(surplus ? counts_.cropped : counts_.short_messages);
  return surplus;
}

void SensorConversion::warn_of_length(const std::string& difference, std::size_t whole,
                                      bool surplus) {
  std::string remedy = length_remedy();
  if (surplus || most_values_ < channels_.size()) {  // else other messages fill the connection
    remedy += fmt::format("{}write [{}] in its connection {}", remedy.empty() ? "" : ", or ", whole,
                          surplus ? "to have all" : "if no message has more");
  }
  warn(fmt::format(
      "{}: surplus values are left out, and channels without a value keep their last one{}{}",
      difference, remedy.empty() ? "" : "; ", remedy));
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
