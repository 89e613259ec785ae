#include "spikeloop/zmq/wire.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/parse_message.hpp"

namespace spikeloop::zmq {
namespace {

using nlohmann::json;

constexpr double kToleranceS = 0.01;

std::optional<double> number_at(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) {
    return std::nullopt;
  }
  return found->get<double>();
}

std::optional<double> plain(const json& entry) {
  return entry.is_number() ? std::optional(entry.get<double>()) : std::nullopt;
}

std::optional<double> scaled(const json& entry) {
  if (!entry.is_object()) {
    return std::nullopt;
  }
  const auto value = number_at(entry, "value");
  const auto low = number_at(entry, "min");
  const auto high = number_at(entry, "max");
  if (!value || !low || !high || !(*low < *high)) {
    return std::nullopt;
  }
  return std::clamp(2 * (*value - *low) / (*high - *low) - 1, -1.0, 1.0);
}

bool is_late(const json& message, double now_unix_s) {
  const auto late = [now_unix_s](const json& entry) {
    const auto stamp = entry.is_object() ? number_at(entry, "ts") : std::nullopt;
    return stamp && now_unix_s - *stamp > kToleranceS;
  };
  return std::any_of(message.begin(), message.end(), late);
}

}  // namespace

ObservationReader::ObservationReader(std::string_view type, std::uint32_t width, bool strict)
    : gym_(type == "GymObservation"),
      strict_(strict),
      channels_(width, std::numeric_limits<double>::quiet_NaN()) {
  if (!gym_ && type != "FloatArray") {
    throw ConfigurationError(with_code(
        Code::unknown_message,
        "message_type '{}' is not known; write message_type=GymObservation or FloatArray", type));
  }
}

bool ObservationReader::read(std::string_view message, double now_unix_s) {
  const json parsed = parse_message<json>(message);
  if (!parsed.is_array()) {
    if (++counts_.malformed == 1) {
      warning_ = fmt::format("a message that is not a JSON array was left out: '{}'{}",
                             message.substr(0, 60), message.size() > 60 ? " ..." : "");
    }
    return false;
  }
  fit(parsed.size());
  ++counts_.messages;
  counts_.late += gym_ && is_late(parsed, now_unix_s) ? 1 : 0;
  for (std::size_t i = 0; i < std::min(parsed.size(), channels_.size()); ++i) {
    const auto value = gym_ ? scaled(parsed[i]) : plain(parsed[i]);
    if (value && std::isfinite(*value)) {
      channels_[i] = *value;
    } else if (++counts_.invalid_readings == 1) {
      warning_ = fmt::format(
          "entry {} is not a reading: {}; {}", i, parsed[i].dump().substr(0, 60),
          gym_ ? "an observation has 'value', and 'min' below 'max'" : "a FloatArray has numbers");
    }
  }
  return true;
}

void ObservationReader::fit(std::size_t count) {
  if (count == channels_.size()) {
    return;
  }
  const std::string text = fmt::format("a message brought {} values, but the port has {} channels",
                                       count, channels_.size());
  if (strict_) {
    throw ConfigurationError(
        with_code(Code::fields_differ, "{}; write [{}] in its connection", text, count));
  }
  std::uint64_t& counter = count > channels_.size() ? counts_.cropped : counts_.short_messages;
  if (++counter == 1) {
    warning_ = fmt::format("{}: {}; write [{}] in its connection", text,
                           count > channels_.size() ? "the last ones are left out"
                                                    : "the others keep their value, 0 at first",
                           count);
  }
  // As in the older program: a channel that nothing has filled yet must not hold back the others.
  for (std::size_t i = count; i < channels_.size(); ++i) {
    channels_[i] = std::isnan(channels_[i]) ? 0.0 : channels_[i];
  }
}

std::string ObservationReader::take_warning() {
  return std::exchange(warning_, {});
}

std::string float_array(std::span<const double> values) {
  return json(std::vector<double>(values.begin(), values.end())).dump();
}

std::string gym_command(std::span<const double> values, double minimum, double maximum,
                        double now_unix_s) {
  json message = json::array();
  for (const double value : values) {
    message.push_back({{"value", value}, {"ts", now_unix_s}, {"max", maximum}, {"min", minimum}});
  }
  return message.dump();
}

}  // namespace spikeloop::zmq
