// Messages of ROS 2 as eProsima's Fast-CDR serializes them, primitive by primitive.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reference_messages.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace reference {

/// Goes by the definition's texts of types, not by the layouts that our codec goes by.
std::vector<std::uint8_t> serialize_cdr(const spikeloop::messages::Catalog& catalog,
                                        const std::string& type, const std::vector<Atom>& atoms);

}  // namespace reference
