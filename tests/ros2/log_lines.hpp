// Messages of /rosout, read without our codec.
#pragma once

#include <cstring>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::test {

/// rcl_interfaces/Log
struct LogLine {
  std::int32_t seconds = 0;
  int level = 0;
  std::string name;
  std::string text;
};

/// XCDR1, little endian: numbers of 4 bytes and lengths of texts begin at multiples of 4.
inline LogLine read_log_line(std::span<const std::byte> message) {
  const std::span<const std::byte> fields = message.subspan(4);
  std::size_t at = 0;
  const auto number = [&] {
    at = (at + 3) / 4 * 4;
    std::uint32_t value = 0;
    std::memcpy(&value, fields.subspan(at, sizeof value).data(), sizeof value);
    at += sizeof value;
    return value;
  };
  const auto text = [&] {
    const std::uint32_t size = number();  // with the 0 at its end
    const auto bytes = fields.subspan(at, size);
    at += size;
    return std::string(reinterpret_cast<const char*>(bytes.data()), size - 1);
  };
  LogLine line;
  line.seconds = static_cast<std::int32_t>(number());
  number();  // nanoseconds
  line.level = std::to_integer<int>(fields[at++]);
  line.name = text();
  line.text = text();
  return line;
}

/// What nodes log on /rosout, also before it listens.
class LogLines {
 public:
  explicit LogLines(topics::Session& session)
      : subscriber_(session.subscriber({.topic = "/rosout",
                                        .message_type = "rcl_interfaces/Log",
                                        .queue = 0,
                                        .latched = true,
                                        .take = [this](auto message) {
                                          const std::lock_guard lock(mutex_);
                                          lines_.push_back(read_log_line(message));
                                        }})) {}

  std::vector<LogLine> lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
  }
  /// Whether a node has logged this part of a text.
  bool has(int level, const std::string& name, const std::string& part) const {
    const std::lock_guard lock(mutex_);
    for (const LogLine& line : lines_) {
      if (line.level == level && line.name == name && line.text.find(part) != std::string::npos) {
        return true;
      }
    }
    return false;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<LogLine> lines_;
  std::unique_ptr<topics::RawSubscriber> subscriber_;  // the last: what it fills is there before
};

}  // namespace spikeloop::test
