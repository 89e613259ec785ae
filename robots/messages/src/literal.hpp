// The values in message definitions: constants, and ROS 2's defaults.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/definition.hpp"

namespace spikeloop::messages {

/// Without blanks around it.
std::string_view trim(std::string_view text);

/// The value of a number type, "-3", "0.5", "true".
/// @throws std::invalid_argument that says what is wrong with it, as in "is not a number".
double parse_number_literal(std::string_view text, Primitive primitive);

/// Takes ROS 2's quotation marks off, '...' or "...", and the backslash before one; a text without
/// marks is as it stands. @throws std::invalid_argument when the closing one is missing.
std::string parse_text_literal(std::string_view text);

/// "[1, 2]" or "['a', 'b']" by its elements, as they stand.
/// @throws std::invalid_argument when a bracket or a quotation mark is missing.
std::vector<std::string_view> split_list_literal(std::string_view text);

/// Where ROS 2's comment begins: the first '#' outside of quotation marks; else the end.
std::size_t find_comment(std::string_view line);

}  // namespace spikeloop::messages
