// The definitions that messages of a session follow.
#pragma once

#include <string>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::topics {

/// Where a type, as users name it, is found.
inline const messages::Catalog& catalog_of(messages::Dialect /*ros*/,
                                           const std::string& /*message_type*/) {
  return messages::Catalog::builtin();
}

}  // namespace spikeloop::topics
