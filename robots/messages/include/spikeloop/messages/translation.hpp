// Messages of one ROS as messages of the other.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::messages {

/// Keeps the bits of every value that both definitions of a type have, in whichever letters: what
/// is D in ROS 1 is d in ROS 2. What only the result has, as the `seq` of a ROS 1 header, is zero
/// or empty; what only the original has is left out.
class Translation {
 public:
  /// @throws ConfigurationError as Catalog::layout, and when the two definitions have fields of one
  /// name in another order or of another type.
  Translation(std::string_view type, const Catalog& from, const Catalog& to);

  /// Replaces `result`. @throws TransportError when `message` ends too early, or is encoded
  /// otherwise.
  void translate(std::span<const std::byte> message, std::vector<std::byte>& result) const;

 private:
  std::shared_ptr<const TypeLayout> from_;
  std::shared_ptr<const TypeLayout> to_;
};

}  // namespace spikeloop::messages
