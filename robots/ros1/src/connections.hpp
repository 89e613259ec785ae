// Who is connected to whom, as the publishers see it.
#pragma once

#include <string>

namespace spikeloop::ros1 {

/// As Session::publishers_know_us.
/// @param self the name of our node
bool publishers_know(const std::string& self, const std::string& topic);

}  // namespace spikeloop::ros1
