// Which box stands in which column, and how high.
#pragma once

#include "diagram.hpp"

namespace spikeloop::app {

/// Sets the boxes' layers, and which arrows go back.
void assign_layers(Diagram& diagram);

/// Sets `y` of boxes, and the levels of arrows that pass layers: few crossings, straight arrows.
/// The boxes' sizes and ports are known.
void assign_heights(Diagram& diagram);

}  // namespace spikeloop::app
