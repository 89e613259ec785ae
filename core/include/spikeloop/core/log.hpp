// Logging interface: libraries report through it, programs decide where it goes.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>
#include <string_view>

namespace spikeloop::log {

enum class Level { debug, info, warning, error };
using Sink = std::function<void(Level, std::string_view message)>;

/// Where messages go; nowhere until it is set. Safe to call from any thread.
void set_sink(Sink sink);

/// Gets every message beside the sink, as long as it lives. Safe to make in any thread.
class Listener {
 public:
  explicit Listener(Sink take);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

 private:
  Sink take_;
};

/// Messages below are dropped before they are formatted; info by default.
void set_level(Level level);
bool enabled(Level level);
void write(Level level, std::string_view message);

template <typename... Arguments>
void debug(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  if (enabled(Level::debug)) {
    write(Level::debug, fmt::format(format, std::forward<Arguments>(arguments)...));
  }
}
template <typename... Arguments>
void info(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  if (enabled(Level::info)) {
    write(Level::info, fmt::format(format, std::forward<Arguments>(arguments)...));
  }
}
template <typename... Arguments>
void warning(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  if (enabled(Level::warning)) {
    write(Level::warning, fmt::format(format, std::forward<Arguments>(arguments)...));
  }
}

}  // namespace spikeloop::log
