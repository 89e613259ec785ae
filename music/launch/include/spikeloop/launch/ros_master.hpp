// What the launcher asks a ROS 1 master, over XML-RPC.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop::launch {

inline constexpr const char* kDefaultMasterUri = "http://localhost:11311";

struct MasterAddress {
  std::string host;
  std::uint16_t port = 0;
};

/// "http://HOST:PORT" with or without a '/' at the end.
/// @throws ConfigurationError that says what to write.
MasterAddress parse_master_uri(std::string_view uri);

/// ROS_MASTER_URI, or the default.
std::string master_uri();

class RosMaster {
 public:
  /// @throws ConfigurationError as parse_master_uri.
  explicit RosMaster(const std::string& uri);

  const std::string& uri() const { return uri_; }
  /// Whether a master answers there.
  bool answers() const;
  /// Says that the host name has no address, and what to do; empty when it has one.
  std::string unresolved() const;
  /// Whether any node publishes this topic; false, too, when the master does not answer.
  bool publishes(const std::string& topic) const;
  /// The nodes that the master has as the topic's publishers: their names.
  std::vector<std::string> publishers(const std::string& topic) const;
  /// Whether a node is there: a master keeps those that were killed.
  bool is_alive(const std::string& node) const;

 private:
  /// The answer's text; nothing when there was none within three seconds.
  std::optional<std::string> call(const std::string& method, const std::string& arguments) const;

  std::string uri_;
  MasterAddress address_;
};

}  // namespace spikeloop::launch
