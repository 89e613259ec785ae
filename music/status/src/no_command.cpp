#include "spikeloop/status/no_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace spikeloop::status {
namespace {

using Counters = std::map<std::string, std::uint64_t>;

struct Endpoints {
  std::map<std::string, Counters> sensors;
  std::map<std::string, Counters> commands;
};

std::uint64_t value_of(const Counters& counters, const std::string& name) {
  const auto found = counters.find(name);
  return found == counters.end() ? 0 : found->second;
}

Endpoints endpoints_of(const nlohmann::json& counters) {
  std::map<std::string, Counters> nodes;
  for (const auto& [key, value] : counters.items()) {
    const auto dot = key.rfind('.');
    if (dot != std::string::npos && value.is_number_unsigned()) {
      nodes[key.substr(0, dot)][key.substr(dot + 1)] = value.get<std::uint64_t>();
    }
  }
  Endpoints endpoints;
  for (auto& [name, node] : nodes) {
    if (node.contains("messages") && node.contains("malformed")) {
      endpoints.sensors[name] = std::move(node);
    } else if (node.contains("stops_sensor_silent")) {
      endpoints.commands[name] = std::move(node);
    }
  }
  return endpoints;
}

std::uint64_t arrived(const Counters& sensor) {
  return value_of(sensor, "messages") + value_of(sensor, "wrong_type");
}

bool is_useless(const Counters& sensor) {
  const std::uint64_t unusable =
      value_of(sensor, "malformed") + value_of(sensor, "without_reading");
  return arrived(sensor) > 0 && value_of(sensor, "messages") <= unusable;
}

/// "none of the 20 messages of 'scan' was usable (malformed: 3, without_reading: 17)"
std::string uselessness(const std::string& name, const Counters& sensor) {
  std::vector<std::string> causes;
  for (const char* cause : {"malformed", "without_reading", "wrong_type"}) {
    if (const std::uint64_t count = value_of(sensor, cause); count > 0) {
      causes.push_back(fmt::format("{}: {}", cause, count));
    }
  }
  return fmt::format("none of the {} messages of '{}' was usable ({})", arrived(sensor), name,
                     fmt::join(causes, ", "));
}

/// The reason that stopped a command most often; empty if none did.
std::string stop_of(const std::map<std::string, Counters>& commands) {
  constexpr std::string_view kPrefix = "stops_";
  std::string cause;
  std::uint64_t most = 0;
  for (const auto& [name, command] : commands) {
    for (const auto& [counter, count] : command) {
      const bool is_end = counter == "stops_ended" || counter == "stops_terminated";
      if (counter.starts_with(kPrefix) && !is_end && count > most) {
        most = count;
        cause = counter.substr(kPrefix.size());
      }
    }
  }
  return cause;
}

std::string cause_of(const Endpoints& endpoints) {
  for (const auto& [name, sensor] : endpoints.sensors) {
    if (is_useless(sensor)) {
      return uselessness(name, sensor);
    }
  }
  for (const auto& [name, sensor] : endpoints.sensors) {
    if (arrived(sensor) == 0) {
      return fmt::format("no message of '{}' arrived", name);
    }
  }
  const std::string stop = stop_of(endpoints.commands);
  return stop.empty() ? "the nodes before the command gave no value"
                      : fmt::format("the robot was stopped (stops_{})", stop);
}

}  // namespace

std::optional<NoCommand> find_no_command(const nlohmann::json& counters) {
  const Endpoints endpoints = endpoints_of(counters);
  const auto sent = [](const auto& command) {
    return value_of(command.second, "commands") + value_of(command.second, "overrides") > 0;
  };
  const auto useless = [](const auto& sensor) { return is_useless(sensor.second); };
  const auto& commands = endpoints.commands;
  const auto& sensors = endpoints.sensors;
  const bool any_useless = std::any_of(sensors.begin(), sensors.end(), useless);
  if (!commands.empty()) {
    if (std::any_of(commands.begin(), commands.end(), sent)) {
      return std::nullopt;
    }
    return NoCommand{any_useless, "no command was sent: " + cause_of(endpoints)};
  }
  const bool all_useless = std::all_of(sensors.begin(), sensors.end(), [&](const auto& sensor) {
    return useless(sensor) || arrived(sensor.second) == 0;
  });
  return any_useless && all_useless ? std::optional(NoCommand{true, cause_of(endpoints)})
                                    : std::nullopt;
}

}  // namespace spikeloop::status
