#include "spikeloop/config/order.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace spikeloop {

namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

std::size_t index_of(const MusicFile& file, std::string_view label) {
  for (std::size_t i = 0; i < file.sections.size(); ++i) {
    if (file.sections[i].label == label) {
      return i;
    }
  }
  return kNone;
}

/// Applications by their place in the file.
class ApplicationGraph {
 public:
  explicit ApplicationGraph(const MusicFile& file)
      : size_(file.sections.size()), receivers_(size_), senders_(size_) {
    for (const auto& c : file.connections) {
      const std::size_t from = index_of(file, c.from_app);
      const std::size_t to = index_of(file, c.to_app);
      if (from != kNone && to != kNone && from != to) {
        receivers_[from].push_back(to);
        senders_[to].push_back(from);
      }
    }
  }

  /// Takes out connections until there is no cycle.
  void break_cycles() {
    std::vector<bool> placed(size_, false);  // upstream of everything else, or cut off
    for (std::size_t count = 0; count < size_; ++count) {
      std::size_t next = first_ready(senders_, placed);
      if (next == kNone) {
        next = first_of_cycle(placed);
        cut_senders(next, placed);
      }
      placed[next] = true;
    }
  }

  /// Receivers before senders; needs a graph without cycles.
  std::vector<std::size_t> downstream_first() const {
    std::vector<bool> placed(size_, false);
    std::vector<std::size_t> order;
    for (std::size_t count = 0; count < size_; ++count) {
      order.push_back(first_ready(receivers_, placed));
      placed[order.back()] = true;
    }
    return order;
  }

 private:
  using Neighbours = std::vector<std::vector<std::size_t>>;

  /// The first application whose neighbours are all placed.
  std::size_t first_ready(const Neighbours& neighbours, const std::vector<bool>& placed) const {
    for (std::size_t i = 0; i < size_; ++i) {
      const bool ready = std::all_of(neighbours[i].begin(), neighbours[i].end(),
                                     [&](std::size_t other) { return placed[other]; });
      if (!placed[i] && ready) {
        return i;
      }
    }
    return kNone;
  }

  std::vector<bool> reachable(std::size_t from, const Neighbours& neighbours,
                              const std::vector<bool>& placed) const {
    std::vector<bool> seen(size_, false);
    std::vector<std::size_t> waiting{from};
    seen[from] = true;
    while (!waiting.empty()) {
      const std::size_t i = waiting.back();
      waiting.pop_back();
      for (const std::size_t other : neighbours[i]) {
        if (!placed[other] && !seen[other]) {
          seen[other] = true;
          waiting.push_back(other);
        }
      }
    }
    return seen;
  }

  /// Every application that is left has a sender that is left. Looks at the cycles that nothing
  /// else that is left feeds: whatever reaches a member is reached by it.
  std::size_t first_of_cycle(const std::vector<bool>& placed) const {
    std::size_t first = kNone;
    for (std::size_t i = 0; i < size_; ++i) {
      if (placed[i]) {
        continue;
      }
      const auto before = reachable(i, senders_, placed);
      const auto after = reachable(i, receivers_, placed);
      bool uppermost = true;
      for (std::size_t other = 0; other < size_; ++other) {
        uppermost = uppermost && (!before[other] || after[other]);
      }
      if (!uppermost) {
        continue;
      }
      const bool fed = std::any_of(senders_[i].begin(), senders_[i].end(),
                                   [&](std::size_t other) { return placed[other]; });
      if (fed) {
        return i;
      }
      first = std::min(first, i);
    }
    return first;
  }

  void cut_senders(std::size_t to, const std::vector<bool>& placed) {
    std::erase_if(senders_[to], [&](std::size_t from) {
      if (!placed[from]) {
        std::erase(receivers_[from], to);
      }
      return !placed[from];
    });
  }

  std::size_t size_;
  Neighbours receivers_;
  Neighbours senders_;
};

/// The best known way to an application.
struct Arrival {
  int continuous_hops = std::numeric_limits<int>::max();
  int hops = 0;
  std::size_t by = kNone;  ///< the last connection
};

}  // namespace

std::vector<std::string> downstream_first(const MusicFile& file) {
  ApplicationGraph graph(file);
  graph.break_cycles();
  std::vector<std::string> labels;
  for (const std::size_t i : graph.downstream_first()) {
    labels.push_back(file.sections[i].label);
  }
  return labels;
}

MusicFile order_downstream_first(MusicFile file) {
  std::vector<MusicSection> sections;
  for (const auto& label : downstream_first(file)) {
    sections.push_back(std::move(file.section(label)));
  }
  file.sections = std::move(sections);
  return file;
}

// Bellman and Ford's relaxation over (continuous hops, hops): a job has few connections.
std::optional<DataPath> data_path(const MusicFile& file, std::string_view from_app,
                                  std::string_view to_app, const IsContinuous& is_continuous) {
  std::vector<Arrival> arrivals(file.sections.size());
  const std::size_t start = index_of(file, from_app);
  const std::size_t goal = index_of(file, to_app);
  if (start == kNone || goal == kNone) {
    return std::nullopt;
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t k = 0; k < file.connections.size(); ++k) {
      const auto& c = file.connections[k];
      const std::size_t from = index_of(file, c.from_app);
      const std::size_t to = index_of(file, c.to_app);
      if (from == kNone || to == kNone || (from != start && arrivals[from].by == kNone)) {
        continue;
      }
      const Arrival& before = arrivals[from];
      const Arrival next{(from == start ? 0 : before.continuous_hops) + (is_continuous(c) ? 1 : 0),
                         (from == start ? 0 : before.hops) + 1, k};
      if (std::tie(next.continuous_hops, next.hops) <
          std::tie(arrivals[to].continuous_hops, arrivals[to].hops)) {
        arrivals[to] = next;
        changed = true;
      }
    }
  }
  if (arrivals[goal].by == kNone) {
    return std::nullopt;
  }
  DataPath path;
  path.continuous_hops = arrivals[goal].continuous_hops;
  std::size_t app = goal;
  do {
    path.connections.push_back(arrivals[app].by);
    app = index_of(file, file.connections[arrivals[app].by].from_app);
  } while (app != start);
  std::reverse(path.connections.begin(), path.connections.end());
  return path;
}

std::optional<int> data_path_ticks(const MusicFile& file, std::string_view from_app,
                                   std::string_view to_app, const IsContinuous& is_continuous) {
  const auto path = data_path(file, from_app, to_app, is_continuous);
  if (!path) {
    return std::nullopt;
  }
  return std::max(0, path->continuous_hops - 1);
}

}  // namespace spikeloop
