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

/// The absolute path of the user's file, from which the launcher has made the one that is run, and
/// the path that the user wrote.
inline constexpr const char* kOriginVariable = "SPIKELOOP_FILE";
inline constexpr const char* kOriginNameVariable = "SPIKELOOP_FILE_NAME";

class JobFile {
 public:
  /// The path in the arguments before MUSIC's Setup, of a file that is there; empty: none.
  static std::string path(int argc, char** argv);
  /// From the arguments before MUSIC's Setup: `music FILE` or `--music-config FILE`. A file that
  /// cannot be found or read leaves this empty: then messages have no line numbers.
  /// What is also said in the file that SPIKELOOP_FILE names, has its locations.
  static JobFile find(int argc, char** argv);
  /// @throws FileError, ConfigurationError; locations as find().
  static JobFile read(const std::string& path);
  JobFile() = default;
  explicit JobFile(MusicFile file);
  /// `origin` is the file that it was made from, and lies in `directory`.
  JobFile(MusicFile file, const MusicFile& origin, std::string directory);

  /// Where the file lies, or the one that it was made from; empty when it was not found.
  std::string directory() const;
  /// The section's, or else the global, key; nothing when it is not written.
  std::optional<std::string> key(const std::string& label, const std::string& name) const;
  /// `np`. @throws ConfigurationError when there is no such section.
  int processes(const std::string& label) const;
  /// Where the section's, or else the global, key stands.
  Location where(const std::string& label, const std::string& key) const;
  /// Of the section's first line.
  Location section_where(const std::string& label) const;
  /// Names of the keys written in the section itself.
  std::vector<std::string> own_keys(const std::string& label) const;
  /// The programs of all sections; empty when the file was not found.
  std::vector<std::string> programs() const;
  /// Ends of connections at this application.
  std::vector<PortUse> ports(const std::string& label) const;
  /// The first end at this port.
  std::optional<PortUse> port(const std::string& label, const std::string& port) const;

 private:
  std::optional<MusicFile> file_;
  std::string directory_;
};

/// The section's label in the value of _MUSIC_CONFIG_: its first field.
std::string label_in_environment(std::string_view music_config);

/// The value of _MUSIC_CONFIG_ as MUSIC can read it: 1.1.16 takes the program's place in the file
/// for a single digit and crashes in the eleventh program. It makes no use of it.
std::string with_one_digit_color(std::string_view music_config);
/// Writes it so into the environment.
void mend_music_config();

/// The part after the last '/'.
std::string basename_of(std::string_view path);

}  // namespace spikeloop::music
