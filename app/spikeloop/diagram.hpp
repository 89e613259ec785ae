// Boxes and arrows of an experiment or a job, as Graphviz draws them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace spikeloop::app {

enum class ArrowStyle { signal, spikes };

struct Box {
  std::string name;
  std::string kind;      ///< its second line
  std::string topic;     ///< of the robot, or of ROS; empty: nothing to do with it
  bool sends = false;    ///< to the robot; else it receives
  bool network = false;  ///< in another colour
};

struct Arrow {
  std::size_t from = 0;  ///< indices of boxes
  std::size_t to = 0;
  std::string from_port{};
  std::string to_port{};
  ArrowStyle style = ArrowStyle::signal;
  std::string label{};  ///< "[100, delay 5 ms]"
  bool delayed = false;
};

struct Diagram {
  std::string title;
  std::string frame;          ///< what the process is
  std::string robot;          ///< empty: there is none
  bool robot_inside = false;  ///< of the frame
  std::vector<Box> boxes;
  std::vector<Arrow> arrows;
};

/// The text that `dot` lays out. Ports are named where a box has several on that side.
std::string to_dot(const Diagram& diagram);

}  // namespace spikeloop::app
