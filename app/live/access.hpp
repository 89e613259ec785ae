// Who may see a run, and who may steer it. Pure functions.
#pragma once

#include <string>
#include <string_view>

namespace spikeloop::view {

/// What a request says of itself.
struct Request {
  std::string host;    ///< "127.0.0.1:8765"
  std::string origin;  ///< of the page that makes it; empty: it is made by no page
  std::string token;   ///< empty: none
};

/// Whether it names this machine: by an address, as localhost, or by its name. A page of another
/// site that has its own name point to this machine is told apart by that.
bool is_our_host(std::string_view host, std::string_view machine);

/// Whether a page of our own makes it, or a program.
bool is_own_origin(std::string_view origin, std::string_view host);

/// Takes as long for every wrong token.
bool same_token(std::string_view given, std::string_view wanted);

}  // namespace spikeloop::view
