#include "start_watch.hpp"

#include <utility>

namespace spikeloop::launch {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kStartGrace{5};
/// mpirun ends the others 1 s after one.
constexpr milliseconds kOften{100};
/// Looking through /proc takes a few milliseconds.
constexpr seconds kSeldom{1};
constexpr seconds kFirst{5};

}  // namespace

StartWatch::StartWatch(std::vector<std::string> labels, Clock::time_point now)
    : labels_(std::move(labels)), began_(now), complete_(now) {}

bool StartWatch::is_due(Clock::time_point now) const {
  return now - looked_ >= (now - began_ < kFirst ? kOften : milliseconds(kSeldom));
}

void StartWatch::take(const std::map<std::string, bool>& living, Clock::time_point now) {
  looked_ = now;
  newest_ = living;
  std::vector<std::string> gone;
  for (const std::string& label : labels_) {
    if (living.contains(label)) {
      seen_.insert(label);
    } else if (seen_.contains(label)) {
      gone.push_back(label);
    }
  }
  if (gone.empty()) {
    complete_ = now;
  }
  if (first_gone_.empty()) {
    first_gone_ = gone;
  }
}

std::vector<std::string> StartWatch::missed() const {
  std::vector<std::string> never;
  for (const std::string& label : labels_) {
    if (!seen_.empty() && !seen_.contains(label)) {
      never.push_back(label);
    }
  }
  return never.empty() ? first_gone_ : never;
}

std::map<std::string, bool> StartWatch::living() const {
  std::map<std::string, bool> living;
  for (const std::string& label : seen_) {
    const auto found = newest_.find(label);
    living[label] = found != newest_.end() && found->second;
  }
  for (const std::string& label : missed()) {
    living.erase(label);
  }
  return living;
}

bool StartWatch::one_has_gone(Clock::time_point now) const {
  return now - complete_ > kStartGrace;
}

}  // namespace spikeloop::launch
