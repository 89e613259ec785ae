// The units that quantities are written in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spikeloop {

/// What may stand behind a number that is kept in `unit`, as parse_quantity takes it: for "s" ns,
/// us, ms, s, min, h. The unit alone when nobody knows it; empty for "1" and "".
std::vector<std::string> units_like(std::string_view unit);

/// Rounds a number to `digits` significant digits, for messages: 217.4 to "220" with two digits.
/// Without an exponent from 1e-4 to 1e16.
std::string format_rounded(double number, int digits);

}  // namespace spikeloop
