#include "access.hpp"

#include <arpa/inet.h>

#include "http.hpp"

namespace spikeloop::view {
namespace {

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
  const std::string name = lower_case(name_of(host));
  return is_address(name) || name == "localhost" || (!name.empty() && name == lower_case(machine));
}

bool is_allowed_origin(std::string_view origin, std::string_view host, bool has_token) {
  return has_token || origin.empty() || lower_case(origin) == "http://" + lower_case(host);
}

bool is_same_token(std::string_view given, std::string_view wanted) {
  unsigned difference = given.size() == wanted.size() ? 0 : 1;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    difference |= static_cast<unsigned>(wanted[i] ^ (i < given.size() ? given[i] : 0));
  }
  return difference == 0;
}

bool needs_no_token(const std::string& name, const nlohmann::json& value) {
  return name == kStopParameter && value == true;
}

std::optional<bool> stop_request(const nlohmann::json& message, bool may_control) {
  std::optional<bool> request;
  if (!message.is_object() || message.value("op", nlohmann::json()) != "setParameters") {
    return request;
  }
  for (const nlohmann::json& parameter : message.value("parameters", nlohmann::json())) {
    if (!parameter.is_object() || parameter.value("name", nlohmann::json()) != kStopParameter) {
      continue;
    }
    const nlohmann::json value = parameter.value("value", nlohmann::json());
    if (value.is_boolean() && (may_control || needs_no_token(kStopParameter, value))) {
      request = value.get<bool>();
    }
  }
  return request;
}

}  // namespace spikeloop::view
