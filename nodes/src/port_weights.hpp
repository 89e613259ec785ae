// The `weights` parameter of nodes that map one port onto another.
#pragma once

#include <string>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Declares `weights`: rows are output channels, columns input channels; `uniform` by default.
ParameterDescription weights_parameter();

/// The table `key` for the two ports' widths.
/// @throws ConfigurationError when the sizes disagree, the table has not as many numbers as its
/// size says, or a weight is not finite.
WeightTable port_weights(const NodeSetup& setup, std::uint32_t output_width,
                         std::uint32_t input_width, const std::string& key = "weights");

}  // namespace spikeloop
