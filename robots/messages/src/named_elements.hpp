// Elements of messages to be written that are chosen by a text: position[name=left_wheel].
#pragma once

#include <string>
#include <vector>

#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::messages {

/// A text that a message has because a path chose an element by it.
struct NamedText {
  FieldPath path;
  std::string text;
};

/// Gives every element that is chosen by a text a place, in the order of first mention, replaces
/// the selectors by it, and returns the texts to write. Arrays beside an array of texts become as
/// long as that.
/// @throws ConfigurationError when more elements are named than an array can have.
std::vector<NamedText> place_named_elements(std::vector<FieldPath>& paths);

/// True for messages with one element per joint in each of several arrays, like
/// sensor_msgs/JointState: they have an array of names, or are a std_msgs/Float32MultiArray or
/// Float64MultiArray.
bool has_parallel_arrays(const TypeLayout& type);

/// Makes parallel arrays of the same message that the paths write equally long.
void align_parallel_arrays(std::vector<FieldPath>& paths);

}  // namespace spikeloop::messages
