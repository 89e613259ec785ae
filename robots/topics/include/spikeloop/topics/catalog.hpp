// The definitions that messages of a session follow.
#pragma once

#include <string>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::topics {

/// Where a type, as users name it, is found: among those that we bring, or in a file of theirs.
/// @throws ConfigurationError as messages::Catalog::for_type.
inline const messages::Catalog& catalog_of(messages::Dialect ros, const std::string& message_type) {
  return messages::Catalog::for_type(ros, message_type);
}

}  // namespace spikeloop::topics
