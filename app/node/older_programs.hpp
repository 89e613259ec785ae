// What the older programs of these names did differently from the node classes.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// Puts the program's defaults in this dialect into the node class's declaration.
void set_dialect_defaults(std::vector<ParameterDescription>& declared, std::string_view program,
                          Dialect dialect);
/// "Defaults in dialect ma: initial=0\n"; empty when they are those of dialect rma.
std::string dialect_note(std::string_view program);

/// Keys that stand in older files and never did anything, or do nothing any more.
std::vector<std::string> ignored_keys(std::string_view program);

/// Another name that an older program has for a key; null when there is none.
const char* older_spelling_of(std::string_view program, std::string_view key);

/// One-to-one weights between ports of different widths: what is surplus on either side has no
/// partner. Nothing when the widths are equal.
/// @throws ConfigurationError when strict; else it is said in a warning.
std::optional<WeightTable> uneven_one_to_one(std::uint32_t inputs, std::uint32_t outputs,
                                             bool strict);

}  // namespace spikeloop
