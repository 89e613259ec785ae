// Compares the messages of a recording with the definition that Spikeloop reads them by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::messages {

enum class Fit : std::uint8_t {
  same,     ///< the same fields
  shorter,  ///< the last fields of our definition are missing
  longer,   ///< more fields follow those of our definition
  other,    ///< fields differ
  unknown   ///< the recording has no definition that can be read
};

struct Comparison {
  Fit fit = Fit::same;
  std::string detail{};                ///< of `other` and `unknown`: the reason
  std::vector<std::string> missing{};  ///< of `shorter`: names of the fields
};

/// Compares the definition in a recording with that of a catalog. Constants, default values and
/// bounds may differ.
/// @param version md5 sum (ROS 1) or type hash (ROS 2) in the recording; empty if there is none
/// @throws ConfigurationError if the catalog does not have `type`
Comparison compare_types(const Schema& recorded, std::string_view version, const Catalog& catalog,
                         std::string_view type);

/// Compares the bytes of a message with a definition: `same`, `shorter` if it ends after some
/// field, `longer`, or `other`.
Comparison compare_message(std::span<const std::byte> message, const TypeLayout& type);

}  // namespace spikeloop::messages
