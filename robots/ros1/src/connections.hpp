// Who is connected to whom, as the publishers see it.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

/// As Session::has_publishers.
bool has_publishers(const std::string& self, const std::string& topic);

/// As Session::publishers_know_us.
/// @param self the name of our node
bool publishers_know(const std::string& self, const std::string& topic);

/// Subscribers of a topic with their types. They come from the nodes themselves: a subscriber of
/// another type has no connection to a publisher.
std::vector<topics::Partner> subscribers(const std::string& self, const std::string& topic);

}  // namespace spikeloop::ros1
