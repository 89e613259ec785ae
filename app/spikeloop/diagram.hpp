// Boxes and arrows of an experiment or a job, before and after they have their places.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace spikeloop::app {

inline constexpr double kMargin = 24;  ///< around the whole picture, in its pixels

enum class BoxStyle { plain, network };
enum class ArrowStyle { signal, spikes };

/// A port that arrows begin or end at. `y` counts from the box's upper edge.
struct DiagramPort {
  std::string name;
  ArrowStyle style = ArrowStyle::signal;
  double y = 0;
};

struct Box {
  std::string name;
  std::string kind;    ///< its second line
  std::string topic;   ///< of the robot, or of ROS; empty: nothing to do with it
  bool sends = false;  ///< to the robot; else it receives
  BoxStyle style = BoxStyle::plain;
  std::vector<DiagramPort> inputs{};
  std::vector<DiagramPort> outputs{};
  // The place.
  std::size_t layer = 0;
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

/// Indices of boxes and of their ports.
struct Arrow {
  std::size_t from = 0;
  std::size_t from_port = 0;
  std::size_t to = 0;
  std::size_t to_port = 0;
  std::string label{};  ///< "100, 5 ms"
  bool delayed = false;
  // The place.
  bool back = false;             ///< goes round below the boxes
  double lane = 0;               ///< y below them
  double down = 0;               ///< x where it leaves for the lane
  double up = 0;                 ///< x where it comes back
  std::vector<double> levels{};  ///< y in the layers that it passes
};

/// How a box and the robot are joined.
struct RobotLine {
  std::size_t box = 0;
  double x = 0;
};

struct Diagram {
  std::string title;
  std::string frame;          ///< what the process is
  std::string robot;          ///< empty: there is none
  bool robot_inside = false;  ///< of the frame
  std::vector<Box> boxes;
  std::vector<Arrow> arrows;
  // The place.
  std::vector<double> layer_x;  ///< left edges
  std::vector<double> layer_width;
  std::vector<RobotLine> robot_lines;
  double inner_top = 0;
  double inner_bottom = 0;  ///< below boxes and lanes
  double robot_top = 0;
  double frame_bottom = 0;
  double width = 0;
  double height = 0;
};

/// Space that a text takes, in pixels.
double text_width(const std::string& text, double size);

/// Longest-path layers from left to right, arrows against them round below.
void lay_out(Diagram& diagram);

/// The picture; `lay_out` comes first.
std::string to_svg(const Diagram& diagram);

}  // namespace spikeloop::app
