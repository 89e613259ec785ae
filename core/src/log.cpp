#include "spikeloop/core/log.hpp"

#include <atomic>
#include <mutex>

#include "spikeloop/core/error.hpp"

namespace spikeloop::log {

namespace {

struct State {
  std::mutex mutex;
  Sink sink;
  std::atomic<Level> level{Level::info};
  std::atomic<bool> has_sink{false};
};

State& state() {
  static State instance;
  return instance;
}

}  // namespace

void set_sink(Sink sink) {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  s.sink = std::move(sink);
  s.has_sink = static_cast<bool>(s.sink);
}

void set_level(Level level) {
  state().level = level;
}

bool enabled(Level level) {
  return state().has_sink && level >= state().level.load();
}

void write(Level level, std::string_view message) {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  if (s.sink && level >= s.level.load()) {
    s.sink(level, one_line(message));
  }
}

}  // namespace spikeloop::log
