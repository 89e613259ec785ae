#include "diagram_layers.hpp"

#include <algorithm>
#include <functional>

namespace spikeloop::app {
namespace {

/// Arrows that lead back into the walk that found them.
void find_back_arrows(Diagram& diagram) {
  enum class State { unseen, open, done };
  std::vector<State> state(diagram.boxes.size(), State::unseen);
  const std::function<void(std::size_t)> visit = [&](std::size_t box) {
    state[box] = State::open;
    for (Arrow& arrow : diagram.arrows) {
      if (arrow.from == box) {
        arrow.back = state[arrow.to] == State::open;
        if (state[arrow.to] == State::unseen) {
          visit(arrow.to);
        }
      }
    }
    state[box] = State::done;
  };
  std::vector<bool> entered(diagram.boxes.size(), false);
  for (const Arrow& arrow : diagram.arrows) {
    entered[arrow.to] = entered[arrow.to] || arrow.from != arrow.to;
  }
  for (const bool round : {false, true}) {  // boxes that nothing leads into come first
    for (std::size_t box = 0; box < diagram.boxes.size(); ++box) {
      if (entered[box] == round && state[box] == State::unseen) {
        visit(box);
      }
    }
  }
}

/// A source stands just before the first that needs it.
void move_sources(Diagram& diagram) {
  for (std::size_t box = 0; box < diagram.boxes.size(); ++box) {
    std::size_t nearest = 0;
    bool source = true;
    for (const Arrow& arrow : diagram.arrows) {
      source = source && (arrow.to != box || arrow.back);
      if (arrow.from == box && !arrow.back) {
        const std::size_t layer = diagram.boxes[arrow.to].layer;
        nearest = nearest == 0 ? layer : std::min(nearest, layer);
      }
    }
    if (source && nearest > 0) {
      diagram.boxes[box].layer = nearest - 1;
    }
  }
}

/// What stands in a layer: a box, or an arrow that passes.
struct Item {
  std::size_t layer = 0;
  double height = 0;
  double y = 0;  ///< of its middle
  double wanted = 0;
};

/// A piece of an arrow between two layers; offsets from the items' middles.
struct Segment {
  std::size_t left = 0;
  double left_offset = 0;
  std::size_t right = 0;
  double right_offset = 0;
};

class Heights {
 public:
  explicit Heights(Diagram& diagram) : diagram_(diagram) {
    for (const Box& box : diagram.boxes) {
      add(box.layer, box.height);
    }
    for (const Arrow& arrow : diagram.arrows) {
      if (!arrow.back) {
        add_segments(arrow);
      }
    }
    for (auto& layer : layers_) {
      spread(layer);
    }
  }

  void settle() {
    constexpr int kSweeps = 60;
    constexpr int kStraighten = 48;  // of these, without another order
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      const bool forward = sweep % 2 == 0;
      const bool last = sweep + kStraighten >= kSweeps;
      for (std::size_t i = 0; i < layers_.size(); ++i) {
        auto& layer = layers_[forward ? i : layers_.size() - 1 - i];
        wish(layer, forward || last, !forward || last);
        if (!last) {
          std::ranges::stable_sort(layer, {},
                                   [&](std::size_t item) { return items_[item].wanted; });
        }
        spread(layer);
      }
    }
    write();
  }

 private:
  static constexpr double kBetween = 34;
  static constexpr double kPassing = 12;

  std::size_t add(std::size_t layer, double height) {
    layers_.resize(std::max(layers_.size(), layer + 1));
    layers_[layer].push_back(items_.size());
    items_.push_back({layer, height});
    return items_.size() - 1;
  }

  void add_segments(const Arrow& arrow) {
    const Box& from = diagram_.boxes[arrow.from];
    const Box& to = diagram_.boxes[arrow.to];
    std::size_t left = arrow.from;
    double offset = from.outputs[arrow.from_port].y - from.height / 2;
    for (std::size_t layer = from.layer + 1; layer < to.layer; ++layer) {
      const std::size_t item = add(layer, kPassing);
      segments_.push_back({left, offset, item, 0});
      left = item;
      offset = 0;
    }
    segments_.push_back({left, offset, arrow.to, to.inputs[arrow.to_port].y - to.height / 2});
  }

  /// Where the items' neighbours want them to be.
  void wish(const std::vector<std::size_t>& layer, bool from_left, bool from_right) {
    std::vector<int> count(items_.size(), 0);
    std::vector<double> sum(items_.size(), 0.0);
    for (const Segment& segment : segments_) {
      const double left = items_[segment.left].y + segment.left_offset;
      const double right = items_[segment.right].y + segment.right_offset;
      if (from_left) {
        sum[segment.right] += left - segment.right_offset;
        ++count[segment.right];
      }
      if (from_right) {
        sum[segment.left] += right - segment.left_offset;
        ++count[segment.left];
      }
    }
    for (const std::size_t i : layer) {
      items_[i].wanted = count[i] > 0 ? sum[i] / count[i] : items_[i].y;
    }
  }

  /// The least sum of squares of distances from where items want to be, in this order and without
  /// overlap: neighbours that are too near form blocks (pool adjacent violators).
  void spread(const std::vector<std::size_t>& layer) {
    struct Block {
      double sum;
      int count;
      double mean() const { return sum / count; }
    };
    std::vector<double> shift;
    std::vector<Block> blocks;
    double at = 0;
    for (std::size_t n = 0; n < layer.size(); ++n) {
      const Item& item = items_[layer[n]];
      at += n == 0 ? 0 : items_[layer[n - 1]].height / 2 + kBetween + item.height / 2;
      shift.push_back(at);
      blocks.push_back({item.wanted - at, 1});
      while (blocks.size() > 1 && blocks[blocks.size() - 2].mean() >= blocks.back().mean()) {
        const Block last = blocks.back();
        blocks.pop_back();
        blocks.back().sum += last.sum;
        blocks.back().count += last.count;
      }
    }
    std::size_t n = 0;
    for (const Block& block : blocks) {
      for (int i = 0; i < block.count; ++i, ++n) {
        items_[layer[n]].y = block.mean() + shift[n];
      }
    }
  }

  void write() {
    double top = 1e9;
    for (const Item& item : items_) {
      top = std::min(top, item.y - item.height / 2);
    }
    for (std::size_t i = 0; i < diagram_.boxes.size(); ++i) {
      diagram_.boxes[i].y = items_[i].y - items_[i].height / 2 - top;
    }
    std::size_t item = diagram_.boxes.size();
    for (Arrow& arrow : diagram_.arrows) {
      if (!arrow.back) {
        const std::size_t from = diagram_.boxes[arrow.from].layer;
        for (std::size_t layer = from + 1; layer < diagram_.boxes[arrow.to].layer; ++layer) {
          arrow.levels.push_back(items_[item++].y - top);
        }
      }
    }
  }

  Diagram& diagram_;
  std::vector<Item> items_;  ///< the boxes first
  std::vector<Segment> segments_;
  std::vector<std::vector<std::size_t>> layers_;
};

}  // namespace

void assign_layers(Diagram& diagram) {
  find_back_arrows(diagram);
  for (bool changed = true; changed;) {
    changed = false;
    for (const Arrow& arrow : diagram.arrows) {
      std::size_t& layer = diagram.boxes[arrow.to].layer;
      const std::size_t least = diagram.boxes[arrow.from].layer + 1;
      if (!arrow.back && layer < least) {
        layer = least;
        changed = true;
      }
    }
  }
  move_sources(diagram);
}

void assign_heights(Diagram& diagram) {
  Heights(diagram).settle();
}

}  // namespace spikeloop::app
