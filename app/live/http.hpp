// Heads of HTTP/1.1 requests and responses (RFC 9112). Pure functions.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace spikeloop::view {

struct HttpRequest {
  std::string method;
  std::string path;
  std::string query;                           ///< Empty if the target has none
  std::map<std::string, std::string> headers;  ///< keys: names in lower case

  /// Empty if the request does not have it.
  std::string_view header(const std::string& name) const;
  /// Value of `name=VALUE` in the query, as it was sent. Empty if there is none.
  std::string_view argument(std::string_view name) const;
  /// True if the list in this header has the word, in upper or lower case.
  bool lists(const std::string& name, std::string_view word) const;
};

/// @param head without the empty line at its end
/// @return nullopt if it is malformed, of another version, or announces a body
std::optional<HttpRequest> parse_head(std::string_view head);

/// Status line and the headers that all responses have. @param more "name: value\r\n"...
std::string response_head(unsigned status, std::string_view more);
/// Also writes the headers for type and length of a body.
std::string response_head(unsigned status, std::string_view type, std::uintmax_t size,
                          std::string_view more);

std::string lower_case(std::string_view text);

}  // namespace spikeloop::view
