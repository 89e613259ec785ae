#include <fmt/format.h>

#include <algorithm>

#include "diagram.hpp"

namespace spikeloop::app {
namespace {

constexpr double kRobotHeight = 54;
constexpr const char* kSignalColour = "#2f6db3";
constexpr const char* kSpikesColour = "#c0392b";
constexpr const char* kMessageColour = "#7d6a33";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return result;
}

const char* colour(ArrowStyle style) {
  return style == ArrowStyle::signal ? kSignalColour : kSpikesColour;
}

const char* head(ArrowStyle style) {
  return style == ArrowStyle::signal ? "signal" : "spikes";
}

/// `more`: further attributes.
std::string text(double x, double y, const std::string& words, const std::string& more) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, more, escaped(words));
}

std::string marker(const char* name, const char* fill) {
  return fmt::format(
      "<marker id=\"{}\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"7\" "
      "markerHeight=\"7\" orient=\"auto\"><path d=\"M0 0L10 5L0 10z\" fill=\"{}\"/></marker>\n",
      name, fill);
}

std::string line(const std::string& path, const char* stroke, const std::string& more) {
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-linejoin=\"round\" "
      "{}/>"
      "\n",
      path, stroke, more);
}

/// From (x, y) to the point before it by a curve that begins and ends level.
std::string curve(double x0, double y0, double x1, double y1) {
  if (y0 == y1) {
    return fmt::format("L{:.1f} {:.1f}", x1, y1);
  }
  const double middle = (x0 + x1) / 2;
  return fmt::format("C{0:.1f} {1:.1f} {0:.1f} {2:.1f} {3:.1f} {2:.1f}", middle, y0, y1, x1);
}

class Writer {
 public:
  explicit Writer(const Diagram& diagram) : diagram_(diagram) {}

  std::string write() {
    begin();
    frame();
    for (const Arrow& arrow : diagram_.arrows) {
      arrow.back ? back_arrow(arrow) : forward_arrow(arrow);
    }
    robot();
    for (const Box& box : diagram_.boxes) {
      draw(box);
    }
    labels();
    legend();
    return out_ + "</svg>\n";
  }

 private:
  void begin() {
    out_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
        "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"Helvetica, Arial, sans-serif\" "
        "font-size=\"13\">\n<defs>\n{2}{3}{4}</defs>\n"
        "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
        diagram_.width, diagram_.height, marker("signal", kSignalColour),
        marker("spikes", kSpikesColour), marker("message", kMessageColour));
  }

  void frame() {
    out_ += text(kMargin, kMargin + 12, diagram_.title,
                 "font-size=\"17\" font-weight=\"bold\" fill=\"#222\"");
    out_ += text(diagram_.width - kMargin, kMargin + 12, diagram_.frame,
                 "text-anchor=\"end\" fill=\"#777\"");
    out_ += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"12\" "
        "fill=\"none\" stroke=\"#999\" stroke-dasharray=\"3 4\"/>\n",
        kMargin, diagram_.inner_top - 18, diagram_.width - 2 * kMargin,
        diagram_.frame_bottom - diagram_.inner_top + 18);
  }

  void draw(const Box& box) {
    const bool network = box.style == BoxStyle::network;
    out_ += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"8\" fill=\"{}\" "
        "stroke=\"{}\" stroke-width=\"1.4\"/>\n",
        box.x, box.y, box.width, box.height, network ? "#fbeceb" : "#e8eef7",
        network ? "#a4433c" : "#44618c");
    const double x = box.x + box.width / 2;
    const double y = box.y + box.height / 2;
    out_ += text(x, y - 4, box.name,
                 "text-anchor=\"middle\" font-size=\"15\" font-weight=\"bold\" fill=\"#222\"");
    out_ += text(x, y + 15, box.kind, "text-anchor=\"middle\" fill=\"#555\"");
    ports(box, box.inputs, true);
    ports(box, box.outputs, false);
  }

  /// A dot for an output, arrows' heads for inputs; names where there are several.
  void ports(const Box& box, const std::vector<DiagramPort>& side, bool left) {
    const double x = left ? box.x : box.x + box.width;
    for (const DiagramPort& port : side) {
      if (!left) {
        out_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\" fill=\"{}\"/>\n", x,
                            box.y + port.y, colour(port.style));
      }
      if (side.size() > 1) {
        out_ += text(left ? x + 8 : x - 8, box.y + port.y + 4, port.name,
                     left ? "font-size=\"11\" fill=\"#555\""
                          : "font-size=\"11\" fill=\"#555\" text-anchor=\"end\"");
      }
    }
  }

  struct Point {
    double x;
    double y;
  };
  Point leaves(const Arrow& arrow) const {
    const Box& box = diagram_.boxes[arrow.from];
    return {box.x + box.width, box.y + box.outputs[arrow.from_port].y};
  }
  Point arrives(const Arrow& arrow) const {
    const Box& box = diagram_.boxes[arrow.to];
    return {box.x - 1, box.y + box.inputs[arrow.to_port].y};
  }
  std::string style_of(const Arrow& arrow) const {
    const ArrowStyle style = diagram_.boxes[arrow.from].outputs[arrow.from_port].style;
    return fmt::format("{}marker-end=\"url(#{})\"",
                       arrow.delayed ? "stroke-dasharray=\"7 4\" " : "", head(style));
  }
  const char* colour_of(const Arrow& arrow) const {
    return colour(diagram_.boxes[arrow.from].outputs[arrow.from_port].style);
  }

  void forward_arrow(const Arrow& arrow) {
    Point at = leaves(arrow);
    const Point end = arrives(arrow);
    std::string path = fmt::format("M{:.1f} {:.1f}", at.x, at.y);
    std::size_t layer = diagram_.boxes[arrow.from].layer;
    for (const double level : arrow.levels) {
      ++layer;
      const double left = diagram_.layer_x[layer];
      path += curve(at.x, at.y, left, level);
      at = {left + diagram_.layer_width[layer], level};
      path += fmt::format("L{:.1f} {:.1f}", at.x, at.y);
    }
    // The last piece is level: that is where the label stands.
    const double flat = end.x - text_width(arrow.label, 12) - 18;
    const double from = std::max(at.x + 20, flat);
    path += curve(at.x, at.y, from, end.y) + fmt::format("L{:.1f} {:.1f}", end.x, end.y);
    out_ += line(path, colour_of(arrow), style_of(arrow));
  }

  void back_arrow(const Arrow& arrow) {
    const Point begin = leaves(arrow);
    const Point end = arrives(arrow);
    constexpr double r = 6;
    const std::string path = fmt::format(
        "M{0:.1f} {1:.1f}L{2:.1f} {1:.1f}Q{3:.1f} {1:.1f} {3:.1f} {4:.1f}L{3:.1f} {5:.1f}"
        "Q{3:.1f} {6:.1f} {2:.1f} {6:.1f}L{7:.1f} {6:.1f}Q{8:.1f} {6:.1f} {8:.1f} {5:.1f}"
        "L{8:.1f} {9:.1f}Q{8:.1f} {10:.1f} {7:.1f} {10:.1f}L{11:.1f} {10:.1f}",
        begin.x, begin.y, arrow.down - r, arrow.down, begin.y + r, arrow.lane - r, arrow.lane,
        arrow.up + r, arrow.up, end.y + r, end.y, end.x);
    out_ += line(path, colour_of(arrow), style_of(arrow));
  }

  void robot() {
    if (diagram_.robot.empty()) {
      return;
    }
    const double y = diagram_.robot_top;
    const double inset = kMargin + (diagram_.robot_inside ? 22 : 0);
    out_ += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"8\" "
        "fill=\"#f5f1e6\" stroke=\"#8c7a44\" stroke-width=\"1.4\"/>\n",
        inset, y, diagram_.width - 2 * inset, kRobotHeight);
    out_ += text(diagram_.width / 2, y + 32, diagram_.robot,
                 "text-anchor=\"middle\" font-size=\"15\" font-weight=\"bold\" fill=\"#222\"");
    for (const RobotLine& joined : diagram_.robot_lines) {
      const Box& box = diagram_.boxes[joined.box];
      const double middle = box.y + box.height / 2;
      const std::string path =
          box.sends ? fmt::format(
                          "M{0:.1f} {1:.1f}L{2:.1f} {1:.1f}Q{3:.1f} {1:.1f} {3:.1f} {4:.1f}"
                          "L{3:.1f} {5:.1f}",
                          box.x + box.width, middle, joined.x - 6, joined.x, middle + 6, y - 2)
                    : fmt::format(
                          "M{0:.1f} {1:.1f}L{0:.1f} {2:.1f}Q{0:.1f} {3:.1f} {4:.1f} {3:.1f}"
                          "L{5:.1f} {3:.1f}",
                          joined.x, y, middle + 6, middle, joined.x + 6, box.x - 1);
      out_ += line(path, kMessageColour, "marker-end=\"url(#message)\"");
    }
  }

  /// Above the end of every arrow, over everything else.
  void labels() {
    const std::string halo =
        "font-size=\"12\" stroke=\"#ffffff\" stroke-width=\"4\" stroke-linejoin=\"round\" "
        "paint-order=\"stroke\" ";
    for (const Arrow& arrow : diagram_.arrows) {
      const Point end = arrives(arrow);
      out_ += text(end.x - 12, end.y - 6, arrow.label,
                   halo + fmt::format("text-anchor=\"end\" fill=\"{}\"", colour_of(arrow)));
    }
    for (const RobotLine& joined : diagram_.robot_lines) {
      const Box& box = diagram_.boxes[joined.box];
      const double y = box.y + box.height / 2 - 6;
      out_ +=
          box.sends
              ? text(joined.x + 6, y, box.topic, halo + fmt::format("fill=\"{}\"", kMessageColour))
              : text(box.x - 14, y, box.topic,
                     halo + fmt::format("text-anchor=\"end\" fill=\"{}\"", kMessageColour));
    }
  }

  void legend() {
    double x = kMargin;
    const double y = diagram_.height - 22;
    const auto entry = [&](const char* words, const char* stroke, const std::string& more) {
      out_ += line(fmt::format("M{:.1f} {:.1f}H{:.1f}", x, y - 4, x + 34), stroke, more);
      out_ += text(x + 42, y, words, "font-size=\"12\" fill=\"#555\"");
      x += 42 + text_width(words, 12) + 26;
    };
    entry("continuous [channels]", kSignalColour, "marker-end=\"url(#signal)\"");
    entry("spikes [channels]", kSpikesColour, "marker-end=\"url(#spikes)\"");
    if (std::ranges::any_of(diagram_.arrows, [](const Arrow& arrow) { return arrow.delayed; })) {
      entry("with delay", "#777", "stroke-dasharray=\"7 4\"");
    }
    if (!diagram_.robot_lines.empty()) {
      entry("messages", kMessageColour, "marker-end=\"url(#message)\"");
    }
  }

  const Diagram& diagram_;
  std::string out_;
};

}  // namespace

std::string to_svg(const Diagram& diagram) {
  return Writer(diagram).write();
}

}  // namespace spikeloop::app
