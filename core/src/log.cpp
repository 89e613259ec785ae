#include "spikeloop/core/log.hpp"

#include <atomic>
#include <mutex>
#include <utility>
#include <vector>

#include "spikeloop/core/error.hpp"

namespace spikeloop::log {

namespace {

struct State {
  std::mutex mutex;
  Sink sink;
  std::vector<const Sink*> listeners;
  std::atomic<Level> level{Level::info};
  std::atomic<bool> is_heard{false};

  /// Under the mutex.
  void look() { is_heard = sink || !listeners.empty(); }
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
  s.look();
}

Listener::Listener(Sink take) : take_(std::move(take)) {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  s.listeners.push_back(&take_);
  s.look();
}

Listener::~Listener() {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  std::erase(s.listeners, &take_);
  s.look();
}

void set_level(Level level) {
  state().level = level;
}

bool enabled(Level level) {
  return state().is_heard && level >= state().level.load();
}

void write(Level level, std::string_view message) {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  if (level < s.level.load()) {
    return;
  }
  const std::string line = one_line(message);
  if (s.sink) {
    s.sink(level, line);
  }
  for (const Sink* listener : s.listeners) {
    (*listener)(level, line);
  }
}

}  // namespace spikeloop::log
