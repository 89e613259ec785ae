// Who may see a run, and who may steer it. Pure functions.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace spikeloop::view {

inline constexpr const char* kStopParameter = "run.stop";

/// True if the header Host names this machine: by an address, as localhost, or by its name.
/// Protects against DNS rebinding: a page of another site sends its own host name.
bool is_our_host(std::string_view host, std::string_view machine);

/// True if the request has the token, or comes from this server's page or from a program that is
/// not a browser. Other pages, such as Foxglove's, need the token.
bool is_allowed_origin(std::string_view origin, std::string_view host, bool has_token);

/// Takes as long for every wrong token.
bool is_same_token(std::string_view given, std::string_view wanted);

/// True if a viewer without the token may set the parameter to this value: it stops the robot.
bool needs_no_token(const std::string& name, const nlohmann::json& value);

/// The new state of STOP that a viewer's message asks for and may ask for. nullopt if none.
std::optional<bool> stop_request(const nlohmann::json& message, bool may_control);

}  // namespace spikeloop::view
