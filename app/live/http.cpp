#include "http.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace spikeloop::view {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

/// Returns the text before the first separator. Removes both from `rest`.
std::string_view take_until(std::string_view& rest, std::string_view separator) {
  const std::size_t at = rest.find(separator);
  const std::string_view before = rest.substr(0, at);
  rest.remove_prefix(at == std::string_view::npos ? rest.size() : at + separator.size());
  return before;
}

bool is_name(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_';
  });
}

const char* reason_of(unsigned status) {
  switch (status) {
    case 101:
      return "Switching Protocols";
    case 200:
      return "OK";
    case 206:
      return "Partial Content";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 416:
      return "Range Not Satisfiable";
    default:
      return "Service Unavailable";
  }
}

}  // namespace

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

std::string_view HttpRequest::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? std::string_view() : std::string_view(found->second);
}

std::string_view HttpRequest::argument(std::string_view name) const {
  std::string_view rest = query;
  while (!rest.empty()) {
    std::string_view value = take_until(rest, "&");
    if (take_until(value, "=") == name) {
      return value;
    }
  }
  return {};
}

bool HttpRequest::lists(const std::string& name, std::string_view word) const {
  std::string_view rest = header(name);
  while (!rest.empty()) {
    if (lower_case(trimmed(take_until(rest, ","))) == word) {
      return true;
    }
  }
  return false;
}

std::optional<HttpRequest> parse_head(std::string_view head) {
  HttpRequest request;
  std::string_view line = take_until(head, kLineEnd);
  request.method = take_until(line, " ");
  std::string_view target = take_until(line, " ");
  request.path = take_until(target, "?");
  request.query = target;
  if (!is_name(request.method) || !request.path.starts_with('/') || line != "HTTP/1.1") {
    return std::nullopt;
  }
  while (!head.empty()) {
    std::string_view value = take_until(head, kLineEnd);
    const std::string name = lower_case(take_until(value, ":"));
    if (!is_name(name)) {
      return std::nullopt;
    }
    // A header that is sent twice is a list (RFC 9110, 5.3). No such list is a valid Host.
    std::string& all = request.headers[name];
    all += (all.empty() ? "" : ", ") + std::string(trimmed(value));
  }
  const std::string_view length = request.header("content-length");
  if (!(length.empty() || length == "0") || request.headers.contains("transfer-encoding")) {
    return std::nullopt;
  }
  return request;
}

std::string response_head(unsigned status, std::string_view more) {
  return fmt::format("HTTP/1.1 {} {}\r\n{}\r\n", status, reason_of(status), more);
}

std::string response_head(unsigned status, std::string_view type, std::uintmax_t size,
                          std::string_view more) {
  return response_head(
      status, fmt::format("content-type: {}\r\ncontent-length: {}\r\n"
                          "content-security-policy: default-src 'self'; connect-src 'self' ws:; "
                          "img-src 'self' blob: data:; frame-ancestors 'none'\r\n"
                          "x-content-type-options: nosniff\r\nreferrer-policy: no-referrer\r\n"
                          "cache-control: no-store\r\n{}",
                          type, size, more));
}

}  // namespace spikeloop::view
