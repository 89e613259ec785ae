// Who is connected to whom, as the publishers see it.
#pragma once

#include <string>

namespace spikeloop::ros1 {

/// As Session::has_publishers.
bool has_publishers(const std::string& self, const std::string& topic);

/// As Session::publishers_know_us.
/// @param self the name of our node
bool publishers_know(const std::string& self, const std::string& topic);

}  // namespace spikeloop::ros1
