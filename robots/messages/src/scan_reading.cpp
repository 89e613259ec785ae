#include "scan_reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostTurns = 2;  // of a scan; an angle_increment in degrees makes more
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kRadian = std::numbers::pi / 180;

/// Largest range_max of a sensor, in m. Drivers without a limit send inf, 3.4e38 or 0.
constexpr double kMostRange = 1e4;
constexpr double kUsualRange = 10;  // m

/// Tolerance in beams. Angles are float32, so a beam between two directions may belong to both.
constexpr double kTolerance = 1e-3;

/// Beams in 360 degrees if the angles are not known: no direction is a second one's equivalent.
constexpr double kNoTurn = 1e300;

/// Directions of which a channel is the nearest one. The unit is the distance between two beams;
/// the first beam is at 0.
struct Sector {
  double centre;
  double half_width;
};

/// The nearest obstacle of the sector's beams. Without such a beam the nearest beam, if it is not
/// farther away than one beam from the next.
/// @param turn number of beams in 360 degrees
/// @param held Held::missing if no beam looks there, Held::no_reading if all beams are NaN
double look(const std::vector<double>& beams, const Sector& sector, double turn, Held& held) {
  const double count = static_cast<double>(beams.size());
  const double reach = std::max(1.0, sector.half_width) + kTolerance;
  const double half_width = sector.half_width + kTolerance;
  double nearest = kNan;
  double nearest_distance = reach;
  double least = kNan;
  bool any = false;
  for (double turns = std::ceil((-reach - sector.centre) / turn);
       sector.centre + turns * turn < count + reach; ++turns) {
    const double centre = sector.centre + turns * turn;
    const double next = std::clamp(std::round(centre), 0.0, count - 1);
    if (std::abs(next - centre) <= nearest_distance) {
      nearest_distance = std::abs(next - centre);
      nearest = beams[static_cast<std::size_t>(next)];
      held = Held::no;
    }
    const double last = std::min(std::floor(centre + half_width), count - 1);
    for (double k = std::max(std::ceil(centre - half_width), 0.0); k <= last; ++k) {
      least = std::fmin(least, beams[static_cast<std::size_t>(k)]);
      any = true;
    }
  }
  const double value = any ? least : nearest;
  held = held == Held::no && std::isnan(value) ? Held::no_reading : held;
  return value;
}

}  // namespace

ScanReading::ScanReading(const Catalog& catalog, const ScanRule& rule)
    : rule_(rule),
      angle_min_(catalog, kLaserScan, "angle_min"),
      angle_max_(catalog, kLaserScan, "angle_max"),
      angle_increment_(catalog, kLaserScan, "angle_increment"),
      range_min_(catalog, kLaserScan, "range_min"),
      range_max_(catalog, kLaserScan, "range_max"),
      ranges_(catalog, kLaserScan, "ranges") {}

std::optional<std::size_t> ScanReading::width() const {
  return rule_.beams == 0 ? std::nullopt : std::optional<std::size_t>(rule_.beams);
}

std::string ScanReading::name_of(std::size_t channel) const {
  if (rule_.beams == 0) {
    return fmt::format("ranges[{}]", is_reversed_ && channel < beams_.size()
                                         ? beams_.size() - 1 - channel
                                         : channel);
  }
  if (!rule_.angles) {
    return fmt::format("beam {} of {}", channel, rule_.beams);
  }
  const auto [first, last] = *rule_.angles;
  const double share =
      rule_.beams == 1 ? 0.5 : static_cast<double>(channel) / static_cast<double>(rule_.beams - 1);
  return fmt::format("beam at {:.4g} deg", (first + share * (last - first)) / kRadian);
}

std::string ScanReading::length_remedy(std::size_t channels) const {
  return fmt::format("set the sensor's key 'beams' to {} to resample scans by angle", channels);
}

std::string ScanReading::no_value_remedy(bool /*missing*/, std::size_t /*channel*/) const {
  return "give channels without a value one, as in initial: -1, an obstacle";
}

bool ScanReading::read(std::span<const std::byte> message, ReadValues& values) {
  read_beams(message);
  order_beams(message);
  if (rule_.beams != 0 && !beams_.empty()) {
    resample(message, values);
    return true;
  }
  for (const double value : beams_) {
    values.numbers.push_back(value);
    values.held.push_back(std::isnan(value) ? Held::no_reading : Held::no);
  }
  return true;
}

double ScanReading::number(const FieldReader& field, std::span<const std::byte> message) {
  scratch_.clear();
  field.read(message, scratch_);
  return scratch_.at(0);
}

std::pair<double, double> ScanReading::limits(std::span<const std::byte> message) {
  if (rule_.range) {
    return *rule_.range;
  }
  const double range_min = number(range_min_, message);
  const double range_max = number(range_max_, message);
  const bool min_is_set = std::isfinite(range_min) && range_min >= 0;
  const bool max_is_set = range_max > 0 && range_max <= kMostRange;
  const double least = min_is_set ? range_min : 0;
  const double most = max_is_set ? range_max : kUsualRange;
  if (least >= most) {
    throw TransportError(with_code(
        Code::damaged_message,
        "range_min {} is not below range_max {}; set the sensor's key 'range' to the limits in "
        "metres, as in [0, {:g}]",
        range_min, range_max, kUsualRange));
  }
  if (!(min_is_set && max_is_set) && !warned_) {
    warned_ = true;
    warn(fmt::format(
        "a {} has range_min {:g} and range_max {:g}, so the range is taken as {:g} m to {:g} m; "
        "set the sensor's key 'range' to the limits in metres, as in [{:g}, {:g}]",
        kLaserScan, range_min, range_max, least, most, least, most));
  }
  return {least, most};
}

void ScanReading::read_beams(std::span<const std::byte> message) {
  const auto [least, most] = limits(message);
  beams_.clear();
  ranges_.read(message, beams_);
  for (double& value : beams_) {
    value = value == 0.0 || std::isnan(value) ? kNan
            : value < least                   ? -1.0
            : value >= most                   ? 1.0
                                              : 2.0 * (value - least) / (most - least) - 1.0;
  }
}

void ScanReading::order_beams(std::span<const std::byte> message) {
  const double increment = number(angle_increment_, message);
  const bool known = std::isfinite(increment) && increment != 0;
  const double direction =
      known ? increment : number(angle_max_, message) - number(angle_min_, message);
  is_reversed_ = direction < 0;
  if (is_reversed_) {
    std::ranges::reverse(beams_);
  }
}

ScanReading::Angles ScanReading::angles_of_beams(std::span<const std::byte> message) {
  const double begin = number(angle_min_, message);
  double increment = number(angle_increment_, message);
  const double gaps = static_cast<double>(beams_.size()) - 1;
  if (!std::isfinite(increment) || increment == 0) {
    increment = (number(angle_max_, message) - begin) / gaps;
  }
  const double turns = std::abs(increment) * std::max(gaps, 1.0) / kTurn;
  if (!std::isfinite(begin) || !(turns > 0 && turns <= kMostTurns)) {
    throw TransportError(with_code(
        Code::damaged_message,
        "angle_min {} and angle_increment {} give its {} beams no angles; leave out 'angles' to "
        "resample from the first to the last beam",
        begin, number(angle_increment_, message), beams_.size()));
  }
  const double rightmost = increment < 0 ? begin + gaps * increment : begin;
  return {std::remainder(rightmost, kTurn), std::abs(increment)};
}

void ScanReading::resample(std::span<const std::byte> message, ReadValues& values) {
  const double gaps = static_cast<double>(beams_.size()) - 1;
  double first = 0;  // as the members of Sector
  double last = gaps;
  double turn = kNoTurn;
  if (rule_.angles) {
    const Angles angles = angles_of_beams(message);
    first = (rule_.angles->first - angles.first) / angles.increment;
    last = (rule_.angles->second - angles.first) / angles.increment;
    turn = kTurn / angles.increment;
  }
  const double spacing = rule_.beams == 1 ? last - first : (last - first) / (rule_.beams - 1);
  for (std::uint32_t i = 0; i < rule_.beams; ++i) {
    const double centre = rule_.beams == 1 ? (first + last) / 2 : first + i * spacing;
    Held held = Held::missing;
    values.numbers.push_back(look(beams_, {centre, spacing / 2}, turn, held));
    values.held.push_back(held);
  }
}

}  // namespace spikeloop::messages
