// Numbers of a sensor_msgs/PointCloud2, which says itself what its points have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::messages {

inline constexpr std::string_view kPointCloud = "sensor_msgs/PointCloud2";

/// "points.x[0:100]": what the points [first, last) have in their field x.
class PointPath {
 public:
  /// Nothing for a path of another kind, which does not begin with "points.".
  /// @throws ConfigurationError when it selects nothing.
  static std::optional<PointPath> parse(std::string_view text);

  /// Number of values; nothing when it is the message's to say.
  std::optional<std::size_t> width() const;
  /// Appends them, row by row. @throws TransportError when the cloud contradicts itself, or has no
  /// such field.
  std::size_t read(Dialect dialect, std::span<const std::byte> message,
                   std::vector<double>& values) const;

 private:
  std::string text_;
  std::string field_;
  std::size_t first_ = 0;
  std::optional<std::size_t> last_;
};

}  // namespace spikeloop::messages
