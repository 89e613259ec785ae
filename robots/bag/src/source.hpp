// A file of messages in any format.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "spikeloop/bag/reader.hpp"

namespace spikeloop::bag {

/// Where a message is in its file. The format defines `block` and `position`.
struct Place {
  TimeNs time;
  std::uint32_t connection;
  std::uint32_t block;
  std::uint64_t position;
};

/// Reads single messages of a file.
class Bytes {
 public:
  Bytes() = default;
  Bytes(const Bytes&) = delete;
  Bytes& operator=(const Bytes&) = delete;
  virtual ~Bytes() = default;

  /// Valid until the next call. @throws FileError if the file is damaged.
  virtual std::span<const std::byte> read(const Place& place) = 0;
};

/// One file of a recording. Times are as recorded, including jumps of the clock.
class Source {
 public:
  explicit Source(std::string path) : path_(std::move(path)) {}
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  const std::string& path() const { return path_; }
  /// Connections that have messages.
  const std::vector<Connection>& connections() const { return connections_; }
  /// All messages in the order of the file. The second call returns none.
  std::vector<Place> take_places() { return std::exchange(places_, {}); }
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// May outlive the source.
  virtual std::unique_ptr<Bytes> bytes() const = 0;

 protected:
  void keep_used_connections();

  std::string path_;
  std::vector<Connection> connections_;
  std::vector<Place> places_;
  std::vector<std::string> warnings_;
};

/// @param name path for error messages: the file itself may be an unpacked copy
/// @throws FileError as Reader.
std::unique_ptr<Source> open_ros1_bag(const std::string& path, const std::string& name);
std::unique_ptr<Source> open_mcap(const std::string& path, const std::string& name);
std::unique_ptr<Source> open_sqlite(const std::string& path, const std::string& name);

/// @param remedy begins with "; "
[[noreturn]] void fail_damaged(const std::string& name, std::string_view why,
                               std::string_view remedy = {});
/// Sets the dialect of a connection from its encoding.
void set_dialect(Connection& connection);

}  // namespace spikeloop::bag
