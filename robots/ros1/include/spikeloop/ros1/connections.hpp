// Who is connected to whom, as the publishers see it.
#pragma once

#include <string>

#include "spikeloop/ros1/session.hpp"

namespace spikeloop::ros1 {

/// Whether a topic has publishers, and each of them counts this node among its subscribers: what
/// they publish from now on comes. A subscriber itself believes so some time before. Asks the
/// master and the publishers, which takes milliseconds.
/// @param topic as whole_topic() gives it
bool publishers_know_us(const Session& session, const std::string& topic);

}  // namespace spikeloop::ros1
