// The text of an MJCF file, for what MuJoCo's model does not keep: lines and names of files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"

namespace spikeloop::vehicle {

struct Attribute {
  std::string_view element;
  std::string_view name;
  std::string_view value;  ///< without quotes; entities are not decoded
  int line = 0;
};

/// Attributes of all elements, in the order of the text, which must outlive them. Leaves out
/// comments. Ends at the first syntax error; MuJoCo reports it.
std::vector<Attribute> parse_attributes(std::string_view text);

/// One file of a model: the model itself, or a file that it includes.
struct ModelText {
  std::string path;
  std::string text;
};

/// Rejects sizes, counts and lengths that are far larger than those of any robot. MuJoCo allocates
/// memory for some of them without a check, and converts others to integers.
/// @throws ConfigurationError with file and line
void check_numbers(const std::vector<ModelText>& files);

/// Line of an attribute: <element name="name" attribute="...">. Without `name`: of the first such
/// element. Only the model's path if there is none.
Location find_attribute(const std::vector<ModelText>& files, std::string_view element,
                        std::string_view attribute, std::string_view name = {});

}  // namespace spikeloop::vehicle
