#include <algorithm>
#include <cmath>

#include "diagram.hpp"
#include "diagram_layers.hpp"

namespace spikeloop::app {
namespace {

constexpr double kFrame = 22;  // from the frame to what is in it
constexpr double kTitle = 46;  // above the boxes, in the frame
constexpr double kPort = 26;   // between ports of a box
constexpr double kLeast = 60;  // height of a box
constexpr double kLane = 26;   // between arrows that go back
constexpr double kStep = 10;   // between upright lines of a gap
constexpr double kLegend = 44;
constexpr double kRobot = 54;
constexpr double kAboveRobot = 40;

void size_box(Box& box) {
  const auto ports = static_cast<double>(std::max(box.inputs.size(), box.outputs.size()));
  box.height = std::max(kLeast, kPort * (ports + 1));
  double names = 0;
  for (const auto* side : {&box.inputs, &box.outputs}) {
    double widest = 0;
    for (const DiagramPort& port : *side) {
      widest = std::max(widest, side->size() > 1 ? text_width(port.name, 11) + 10 : 0);
    }
    names += widest;
  }
  box.width = std::max({120.0, text_width(box.name, 15) + 32, text_width(box.kind, 13) + 28});
  box.width += names;
  for (auto* side : {&box.inputs, &box.outputs}) {
    for (std::size_t i = 0; i < side->size(); ++i) {
      const double share = (static_cast<double>(i) + 1) / (static_cast<double>(side->size()) + 1);
      (*side)[i].y = box.height * share;
    }
  }
}

/// What has to fit before a layer, or behind the last one.
struct Gap {
  double label = 0;
  int downs = 0;  ///< upright lines at its left side
  int ups = 0;    ///< and beside them
  double width(bool inner) const {
    const double lines = kStep * (downs + ups) + (downs + ups > 0 ? 12 : 0);
    return std::max(inner ? 76.0 : 0.0, label + lines + (label > 0 ? 42 : 16));
  }
};

class Columns {
 public:
  explicit Columns(Diagram& diagram) : diagram_(diagram) {
    std::size_t layers = 0;
    for (const Box& box : diagram.boxes) {
      layers = std::max(layers, box.layer + 1);
    }
    gaps_.resize(layers + 1);
    diagram.layer_width.assign(layers, 0);
    diagram.layer_x.assign(layers, 0);
    for (const Box& box : diagram.boxes) {
      double& width = diagram.layer_width[box.layer];
      width = std::max(width, box.width);
    }
  }

  void place() {
    collect_labels();
    count_lines();
    double x = kMargin + kFrame;
    for (std::size_t layer = 0; layer < diagram_.layer_x.size(); ++layer) {
      x += gaps_[layer].width(layer > 0);
      diagram_.layer_x[layer] = x;
      x += diagram_.layer_width[layer];
    }
    for (Box& box : diagram_.boxes) {
      box.x = diagram_.layer_x[box.layer];
      box.width = diagram_.layer_width[box.layer];
    }
    place_lines();
    diagram_.width = x + gaps_.back().width(false) + kFrame + kMargin;
  }

 private:
  void collect_labels() {
    for (const Arrow& arrow : diagram_.arrows) {
      double& label = gaps_[diagram_.boxes[arrow.to].layer].label;
      label = std::max(label, text_width(arrow.label, 12));
    }
    for (const Box& box : diagram_.boxes) {
      if (!diagram_.robot.empty() && !box.topic.empty()) {
        double& label = gaps_[box.sends ? box.layer + 1 : box.layer].label;
        label = std::max(label, text_width(box.topic, 12));
      }
    }
  }

  void count_lines() {
    for (const Arrow& arrow : diagram_.arrows) {
      if (arrow.back) {
        ++gaps_[diagram_.boxes[arrow.from].layer + 1].downs;
        ++gaps_[diagram_.boxes[arrow.to].layer].ups;
      }
    }
    for (const Box& box : diagram_.boxes) {
      if (!diagram_.robot.empty() && !box.topic.empty()) {
        ++(box.sends ? gaps_[box.layer + 1].downs : gaps_[box.layer].ups);
      }
    }
  }

  /// The left edge of a gap.
  double begin(std::size_t gap) const {
    return gap == 0 ? diagram_.layer_x[0] - gaps_[0].width(false)
                    : diagram_.layer_x[gap - 1] + diagram_.layer_width[gap - 1];
  }
  double next_down(std::size_t gap) { return begin(gap) + 12 + kStep * downs_[gap]++; }
  double next_up(std::size_t gap) {
    return begin(gap) + 12 + kStep * (gaps_[gap].downs + ups_[gap]++);
  }

  void place_lines() {
    downs_.assign(gaps_.size(), 0);
    ups_.assign(gaps_.size(), 0);
    for (std::size_t i = 0; i < diagram_.boxes.size(); ++i) {
      const Box& box = diagram_.boxes[i];
      if (!diagram_.robot.empty() && !box.topic.empty() && !box.sends) {
        diagram_.robot_lines.push_back({i, next_up(box.layer)});
      }
    }
    for (Arrow& arrow : diagram_.arrows) {
      if (arrow.back) {
        arrow.down = next_down(diagram_.boxes[arrow.from].layer + 1);
        arrow.up = next_up(diagram_.boxes[arrow.to].layer);
      }
    }
    for (std::size_t i = 0; i < diagram_.boxes.size(); ++i) {
      const Box& box = diagram_.boxes[i];
      if (!diagram_.robot.empty() && !box.topic.empty() && box.sends) {
        diagram_.robot_lines.push_back({i, next_down(box.layer + 1)});
      }
    }
  }

  Diagram& diagram_;
  std::vector<Gap> gaps_;
  std::vector<int> downs_;
  std::vector<int> ups_;
};

/// Short ways round are nearer to the boxes.
void place_lanes(Diagram& diagram, double bottom) {
  std::vector<Arrow*> back;
  for (Arrow& arrow : diagram.arrows) {
    if (arrow.back) {
      back.push_back(&arrow);
    }
  }
  std::ranges::stable_sort(back, {},
                           [](const Arrow* arrow) { return std::fabs(arrow->down - arrow->up); });
  double lane = bottom + kLane / 2;
  for (Arrow* arrow : back) {
    lane += kLane / 2 + 2;
    arrow->lane = lane;
    lane += kLane / 2 - 2;
  }
  diagram.inner_bottom = back.empty() ? bottom : lane;
}

}  // namespace

double text_width(const std::string& text, double size) {
  double units = 0;
  for (const char c : text) {
    const bool narrow = std::string_view("iljtfr.,:;|![]()/ '").find(c) != std::string_view::npos;
    const bool wide = std::string_view("mwMW").find(c) != std::string_view::npos;
    units += narrow ? 0.36 : (wide ? 0.9 : 0.6);
  }
  return units * size;
}

void lay_out(Diagram& diagram) {
  for (Box& box : diagram.boxes) {
    size_box(box);
  }
  assign_layers(diagram);
  assign_heights(diagram);
  Columns(diagram).place();
  diagram.inner_top = kMargin + kTitle;
  double bottom = 0;
  for (Box& box : diagram.boxes) {
    box.y += diagram.inner_top + kFrame;
    bottom = std::max(bottom, box.y + box.height);
  }
  for (Arrow& arrow : diagram.arrows) {
    for (double& level : arrow.levels) {
      level += diagram.inner_top + kFrame;
      bottom = std::max(bottom, level);
    }
  }
  place_lanes(diagram, bottom);
  diagram.inner_bottom += kFrame;
  const double least = text_width(diagram.title, 17) + text_width(diagram.frame, 13) + 120;
  diagram.width = std::max({diagram.width, least, 520.0});
  diagram.frame_bottom = diagram.inner_bottom;
  double bottom_of_all = diagram.inner_bottom;
  if (!diagram.robot.empty()) {
    diagram.robot_top = diagram.inner_bottom + (diagram.robot_inside ? kFrame / 2 : kAboveRobot);
    bottom_of_all = diagram.robot_top + kRobot;
    if (diagram.robot_inside) {
      bottom_of_all += kFrame;
      diagram.frame_bottom = bottom_of_all;
    }
  }
  diagram.height = bottom_of_all + kLegend + kMargin / 2;
}

}  // namespace spikeloop::app
