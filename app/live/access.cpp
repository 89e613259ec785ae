#include "access.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>

namespace spikeloop::view {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

/// Without the port, and without the brackets of an IPv6 address.
std::string name_of(std::string_view host) {
  if (host.starts_with('[')) {
    return std::string(host.substr(1, host.find(']') - 1));
  }
  return std::string(host.substr(0, host.find(':')));
}

bool is_address(const std::string& name) {
  unsigned char bytes[sizeof(in6_addr)];
  return inet_pton(AF_INET, name.c_str(), bytes) == 1 ||
         inet_pton(AF_INET6, name.c_str(), bytes) == 1;
}

}  // namespace

bool is_our_host(std::string_view host, std::string_view machine) {
  const std::string name = lower(name_of(host));
  return is_address(name) || name == "localhost" || (!name.empty() && name == lower(machine));
}

bool is_own_origin(std::string_view origin, std::string_view host) {
  // A page that is a file on this machine is a program that the user has started, such as Foxglove.
  return origin.empty() || origin == "file://" || lower(origin) == "http://" + lower(host);
}

bool same_token(std::string_view given, std::string_view wanted) {
  unsigned difference = given.size() == wanted.size() ? 0 : 1;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    difference |= static_cast<unsigned>(wanted[i] ^ (i < given.size() ? given[i] : 0));
  }
  return difference == 0;
}

}  // namespace spikeloop::view
