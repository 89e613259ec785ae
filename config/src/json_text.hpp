// JSON texts with messages that name line and column.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop::json_text {

/// "not JSON: unexpected end of input; expected ']'" from nlohmann-json's message.
std::string reason(const std::string& message);

/// What is wrong with a text before it is parsed: empty, binary; empty when nothing is.
std::string not_text(std::string_view text);

/// Keeps the order of keys. C comments are allowed, as the older programs' parser did.
/// @throws ConfigurationError at the line and column: not JSON, a key written twice.
nlohmann::ordered_json parse(std::string_view text, const std::string& file);

/// Where the last of these keys stands, each inside of the one before it; as far as it is found.
Location locate_key(std::string_view text, const std::vector<std::string>& keys,
                    const std::string& file);

/// A value as it was written, and what it holds, all with one place.
WrittenValue written_value(const nlohmann::ordered_json& value, const Location& where);

/// A value for messages: at most 60 characters of its JSON, "an array" or "an object".
std::string shown_json(const nlohmann::ordered_json& value);

}  // namespace spikeloop::json_text
