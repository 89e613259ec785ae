// The .music file behind this process, as far as it can be found: it says where things stand, and
// which ports MUSIC will wait for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop::music {

/// One end of a connection.
struct PortUse {
  std::string port;
  Direction direction = Direction::input;
  const MusicConnection* connection = nullptr;
};

class JobFile {
 public:
  /// From the arguments before MUSIC's Setup: `music FILE` or `--music-config FILE`. A file that
  /// cannot be found or read leaves this empty: then messages have no line numbers.
  static JobFile find(int argc, char** argv);
  JobFile() = default;
  explicit JobFile(MusicFile file) : file_(std::move(file)) {}

  /// Where the file lies; empty when it was not found.
  std::string directory() const;
  /// Where the section's, or else the global, key stands.
  Location where(const std::string& label, const std::string& key) const;
  /// Names of the keys written in the section itself.
  std::vector<std::string> own_keys(const std::string& label) const;
  /// Ends of connections at this application.
  std::vector<PortUse> ports(const std::string& label) const;

 private:
  std::optional<MusicFile> file_;
};

/// The section's label in the value of _MUSIC_CONFIG_: its first field.
std::string label_in_environment(std::string_view music_config);

/// The section's label before Setup: from _MUSIC_CONFIG_ or `--app-label`; else the basename of
/// argv[0].
std::string section_label(int argc, char** argv);

/// The part after the last '/'.
std::string basename_of(std::string_view path);

}  // namespace spikeloop::music
