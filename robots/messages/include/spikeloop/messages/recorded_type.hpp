// Compares the messages of a recording with the definition that Spikeloop reads them by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::messages {

enum class Fit : std::uint8_t {
  same,     ///< the same fields
  shorter,  ///< the last fields of our definition are missing
  longer,   ///< more fields follow those of our definition
  other,    ///< fields differ
  unknown   ///< the recording has no definition that can be read
};

struct Comparison {
  Fit fit = Fit::same;
  std::string detail{};                ///< of `other` and `unknown`: the reason
  std::vector<std::string> missing{};  ///< names of our last fields that messages do not have
};

/// Compares the definition in a recording with that of a catalog. Constants, default values and
/// bounds may differ.
/// @param version md5 sum (ROS 1) or type hash (ROS 2) in the recording; empty if there is none
/// @throws ConfigurationError if the catalog does not have `type`
Comparison compare_types(const Schema& recorded, std::string_view version, const Catalog& catalog,
                         std::string_view type);

/// Compares the bytes of a message with a definition: `same`, `shorter` if it ends after some
/// field, `longer`, or `other`.
Comparison compare_message(std::span<const std::byte> message, const TypeLayout& type);

/// Description of a topic's messages in a recording.
struct RecordedTopic {
  std::string topic;
  std::string type;                               ///< "sensor_msgs/LaserScan"
  Schema schema;                                  ///< empty if recordings of this kind have none
  std::string version;                            ///< as of compare_types()
  std::optional<std::vector<std::byte>> first{};  ///< first message; nullopt if there is none
};

/// Compares the definition in a recording with that of a catalog and, because a recorder may have
/// written the definition of another version, the first message. `unknown`: the definition is
/// replaced by that of the catalog, which fits the message.
/// @throws ConfigurationError if the catalog does not have the type
Comparison compare_recorded(const RecordedTopic& recorded, const Catalog& catalog);

/// Warning that the definition in the recording is replaced by that of the catalog. Empty if it is
/// not replaced, and if recordings of this kind have no definitions.
std::string replacement_warning(const RecordedTopic& recorded, const Comparison& compared);

struct RecordedLayout {
  /// Layout with the fields of the first message.
  std::shared_ptr<const TypeLayout> type;
  std::vector<std::string> warnings;
};

/// Layout by which all fields of a recording's messages can be read: that of the definition in the
/// recording, or Spikeloop's own if that cannot be used.
/// @throws ConfigurationError: the definition cannot be used, and Spikeloop has none that fits
RecordedLayout layout_of(const RecordedTopic& recorded, Dialect dialect);

}  // namespace spikeloop::messages
