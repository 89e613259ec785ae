#pragma once

#include <string>
#include <string_view>

namespace spikeloop::discovery {

/// True if CYCLONEDDS_URI contains the element, or if one of its files does. The variable is a list
/// of XML and files, separated by commas.
bool has_element(const std::string& cyclone, std::string_view element);

}  // namespace spikeloop::discovery
