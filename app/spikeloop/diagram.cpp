#include "diagram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace spikeloop::app {
namespace {

constexpr const char* kSignalColour = "#2f6db3";
constexpr const char* kSpikesColour = "#c0392b";
constexpr const char* kMessageColour = "#7d6a33";

/// Text inside of Graphviz's labels in HTML.
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

std::string in_colour(const char* colour, const std::string& text) {
  return fmt::format("<font color=\"{}\">{}</font>", colour, text);
}

const char* colour_of(ArrowStyle style) {
  return style == ArrowStyle::signal ? kSignalColour : kSpikesColour;
}

/// The title, and what the colours mean.
std::string heading(const Diagram& diagram) {
  const auto is_message = [](const Box& box) { return !box.topic.empty(); };
  const bool delayed =
      std::ranges::any_of(diagram.arrows, [](const Arrow& arrow) { return arrow.delayed; });
  return fmt::format("<font point-size=\"17\"><b>{}</b></font>&#160;&#160; {}, {}{}{}",
                     escaped(diagram.title), in_colour(kSignalColour, "continuous [channels]"),
                     in_colour(kSpikesColour, "spikes [channels]"),
                     std::ranges::any_of(diagram.boxes, is_message)
                         ? ", " + in_colour(kMessageColour, "messages")
                         : "",
                     delayed ? ", dashed: with delay" : "");
}

std::string node(const std::string& id, const std::string& label, const char* fill,
                 const char* edge) {
  return fmt::format("    {} [label=<{}>, fillcolor=\"{}\", color=\"{}\"];\n", id, label, fill,
                     edge);
}

std::string node_of(std::size_t index, const Box& box) {
  const std::string label =
      fmt::format("<b>{}</b><br/><font point-size=\"11\" color=\"#555555\">{}</font>",
                  escaped(box.name), box.kind.empty() ? " " : escaped(box.kind));
  const std::string id = fmt::format("n{}", index);
  return box.network ? node(id, label, "#fbeceb", "#a4433c")
                     : node(id, label, "#e8eef7", "#44618c");
}

std::string edge(const std::string& from, const std::string& to, const char* colour,
                 const std::string& label, const std::string& more) {
  return fmt::format("  {0} -> {1} [color=\"{2}\", fontcolor=\"{2}\", label=<{3}>{4}];\n", from, to,
                     colour, label.empty() ? " " : escaped(label), more);
}

/// Boxes with several ports on one side.
std::set<std::size_t> with_several(const Diagram& diagram, std::size_t Arrow::*box,
                                   std::string Arrow::*port) {
  std::set<std::pair<std::size_t, std::string>> ports;
  std::set<std::size_t> seen;
  std::set<std::size_t> result;
  for (const Arrow& arrow : diagram.arrows) {
    if (ports.emplace(arrow.*box, arrow.*port).second && !seen.insert(arrow.*box).second) {
      result.insert(arrow.*box);
    }
  }
  return result;
}

std::string connections(const Diagram& diagram) {
  const auto senders = with_several(diagram, &Arrow::from, &Arrow::from_port);
  const auto receivers = with_several(diagram, &Arrow::to, &Arrow::to_port);
  std::string text;
  for (const Arrow& arrow : diagram.arrows) {
    std::string more = arrow.delayed ? ", style=dashed" : "";
    if (senders.contains(arrow.from)) {
      more += fmt::format(", taillabel=<{}>", escaped(arrow.from_port));
    }
    if (receivers.contains(arrow.to)) {
      more += fmt::format(", headlabel=<{}>", escaped(arrow.to_port));
    }
    text += edge(fmt::format("n{}", arrow.from), fmt::format("n{}", arrow.to),
                 colour_of(arrow.style), arrow.label, more);
  }
  return text;
}

/// Beside the boxes: the robot stands below them.
std::string messages(const Diagram& diagram) {
  std::string text;
  for (std::size_t i = 0; i < diagram.boxes.size(); ++i) {
    const Box& box = diagram.boxes[i];
    if (!diagram.robot.empty() && !box.topic.empty()) {
      const std::string id = fmt::format("n{}", i);
      text += edge(box.sends ? id : "robot", box.sends ? "robot" : id, kMessageColour,
                   " " + box.topic, ", constraint=false");
    }
  }
  return text;
}

}  // namespace

std::string to_dot(const Diagram& diagram) {
  const std::string robot =
      diagram.robot.empty()
          ? ""
          : node("robot", fmt::format("<b>{}</b>", escaped(diagram.robot)), "#f5f1e6", "#8c7a44");
  std::string boxes;
  for (std::size_t i = 0; i < diagram.boxes.size(); ++i) {
    boxes += node_of(i, diagram.boxes[i]);
  }
  return fmt::format(
      "digraph {{\n"
      "  graph [rankdir=LR, fontname=\"Helvetica\", bgcolor=white, pad=0.3, nodesep=0.35, "
      "ranksep=0.6, labelloc=t, labeljust=l, label=<{}>];\n"
      "  node [shape=box, style=\"rounded,filled\", fontname=\"Helvetica\", margin=\"0.2,0.1\"];\n"
      "  edge [fontname=\"Helvetica\", fontsize=11, labelfontsize=9, penwidth=1.6, "
      "arrowsize=0.7];\n"
      "  subgraph cluster_process {{\n"
      "    graph [style=\"rounded,dotted\", color=\"#999999\", fontcolor=\"#777777\", "
      "fontsize=12, labeljust=r, label=<{}>];\n"
      "{}{}  }}\n{}{}{}}}\n",
      heading(diagram), escaped(diagram.frame), boxes, diagram.robot_inside ? robot : "",
      diagram.robot_inside ? "" : robot, connections(diagram), messages(diagram));
}

}  // namespace spikeloop::app
