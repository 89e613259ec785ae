// JSON from other programs. Copying or printing a value recurses, so that a few thousand nested
// brackets would exhaust the stack.
#pragma once

#include <string_view>

namespace spikeloop {

/// Never throws because of the text: returns a discarded value if it is not JSON, or has more than
/// `deepest` nested arrays and objects. What is deeper is not stored.
/// @tparam Json nlohmann::json
template <typename Json>
Json parse_message(std::string_view text, int deepest = 20) {
  bool too_deep = false;
  const auto watch = [&](int depth, typename Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > deepest;
    return depth <= deepest;
  };
  Json value = Json::parse(text, watch, false);
  return too_deep ? Json(Json::value_t::discarded) : value;
}

}  // namespace spikeloop
