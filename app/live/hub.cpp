#include "hub.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "access.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::view {
namespace {

using nlohmann::json;

constexpr const char* kPause = "run.pause";
constexpr const char* kStep = "run.step";
constexpr const char* kSpeed = "run.speed";
constexpr const char* kExtension = ".feed";

/// So much of one process is read before the next one's turn.
constexpr std::size_t kMostAtOnce = 4096;

}  // namespace

Hub::Hub(std::string folder, bool recording)
    : folder_(std::move(folder)), recording_(recording), stop_(folder_) {
  channels_.push_back({"/spikeloop/view", "json", "spikeloop.View", "jsonschema",
                       R"({"type": "object", "properties": {"lost": {"type": "integer"},
                           "dropped": {"type": "integer"}}})"});
}

std::size_t Hub::look() {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    const std::string path = entry.path().string();
    if (entry.path().extension() == kExtension && !known_.contains(path)) {
      processes_.push_back({live::FeedReader(path), {}});
      known_.insert(path);  // only now: if the file cannot be opened, the next call tries again
    }
  }
  for (Process& process : processes_) {
    for (live::Channel& channel : process.feed.new_channels()) {
      process.numbers.push_back(static_cast<std::uint32_t>(channels_.size()));
      channels_.push_back(std::move(channel));
    }
  }
  return channels_.size();
}

void Hub::read(const Take& take) {
  for (Process& process : processes_) {
    for (std::size_t i = 0; i < kMostAtOnce; ++i) {
      const auto record = process.feed.next();
      if (!record) {
        break;
      }
      time_ = std::max(time_, record->time);
      if (record->channel < process.numbers.size()) {
        take(process.numbers[record->channel], record->time, record->message);
      }
    }
  }
}

std::uint32_t Hub::beginnings() {
  std::uint32_t count = 0;
  for (Process& process : processes_) {
    count += process.feed.beginnings();
  }
  if (count != beginnings_) {
    beginnings_ = count;
    time_ = 0;
  }
  return count;
}

void Hub::watch() {
  for (Process& process : processes_) {
    process.feed.watch();
  }
}

std::uint64_t Hub::lost() const {
  std::uint64_t lost = 0;
  for (const Process& process : processes_) {
    lost += process.feed.lost();
  }
  return lost;
}

bool Hub::has(bool live::About::*property) const {
  return std::ranges::any_of(
      processes_, [&](const Process& process) { return process.feed.about().*property; });
}

json Hub::parameters() const {
  json result = json::array();
  const auto add = [&](const char* name, const json& value) {
    result.push_back({{"name", name}, {"value", value}});
  };
  if (!recording_ && (processes_.empty() || has(&live::About::commands))) {
    add(kStopParameter, stop_.is_pressed());  // also before the run has begun
  }
  if (has(&live::About::pausable)) {
    const live::FeedReader& feed = processes_.front().feed;  // the only one
    add(kPause, feed.paused());
    add(kStep, feed.steps());
    add(kSpeed, feed.speed());
  }
  for (const Process& process : processes_) {
    for (std::size_t i = 0; i < process.feed.parameters().size(); ++i) {
      add(process.feed.parameters()[i].name.c_str(), process.feed.value(i));
    }
  }
  return result;
}

std::string Hub::change(const std::string& name, double value) {
  for (Process& process : processes_) {
    const auto& parameters = process.feed.parameters();
    const auto found = std::ranges::find(parameters, name, &live::Parameter::name);
    if (found == parameters.end()) {
      continue;
    }
    if (!(value >= found->minimum && value <= found->maximum)) {
      return fmt::format("parameter '{}' is from {} to {} {}, not {}", name, found->minimum,
                         found->maximum, found->unit, value);
    }
    process.feed.change(static_cast<std::size_t>(found - parameters.begin()), value);
  }
  return {};
}

std::string Hub::set(const std::string& name, const json& value) {
  const json all = parameters();
  const auto known =
      std::ranges::any_of(all, [&](const json& parameter) { return parameter.at("name") == name; });
  if (!known) {
    return fmt::format("this run has no parameter '{}'", name);
  }
  const bool flag = name == kStopParameter || name == kPause;
  if (flag ? !value.is_boolean() : !value.is_number()) {
    return fmt::format("parameter '{}' is {}, not {}", name, flag ? "true or false" : "a number",
                       value.dump());
  }
  if (name == kSpeed && !(value.get<double>() >= 0 && std::isfinite(value.get<double>()))) {
    return fmt::format("parameter '{}' is 0 or more, not {}", name, value.dump());
  }
  if (name != kStopParameter && name != kPause && name != kStep && name != kSpeed) {
    return change(name, value.get<double>());
  }
  for (Process& process : processes_) {
    if (name == kPause) {
      process.feed.pause(value.get<bool>());
    } else if (name == kStep) {
      process.feed.step();
    } else if (name == kSpeed) {
      process.feed.set_speed(value.get<double>());
    }
  }
  return {};
}

}  // namespace spikeloop::view
