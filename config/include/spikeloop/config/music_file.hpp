// MUSIC's `.music` files: text to an object that knows where everything stood, and back.
//
// The grammar is that of MUSIC 1.1 and 1.2. What MUSIC reads, this reads with the same meaning;
// what MUSIC takes for something else without a word (a line without '=', a byte order mark, a key
// that its own launcher cannot pass on) is an error here, as is everything that it ends on or hangs
// at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/diagnostic.hpp"

namespace spikeloop {

/// `name=value`. A key written twice in a section keeps its first place and its last value.
struct MusicKey {
  std::string name;
  std::string value;
  Location where;  ///< of the value that holds
};

/// `[label]`: one application. A section that is opened again goes on.
struct MusicSection {
  std::string label;
  std::vector<MusicKey> keys;
  Location where;
};

enum class Communication { point_to_point, collective };
enum class Processing { tree, table };

/// `from_app.from_port -> to_app.to_port [width, communication, processing]`.
/// An application that was left out has been filled in from the section.
struct MusicConnection {
  std::string from_app;
  std::string from_port;
  std::string to_app;
  std::string to_port;
  std::optional<std::uint32_t> width;  ///< channels; MUSIC only passes it on
  Communication communication = Communication::point_to_point;
  Processing processing = Processing::tree;
  Location where;
};

/// A whole file. Sections in the order in which they were first opened, connections in the order in
/// which they stand.
struct MusicFile {
  std::string path;
  std::vector<MusicKey> globals;  ///< keys before the first section; they hold in every section
  std::vector<MusicSection> sections;
  std::vector<MusicConnection> connections;
  /// What MUSIC reads without a word, and is hardly meant: a key written twice, a section opened
  /// again.
  Diagnostics warnings;

  /// Null when there is no such section.
  const MusicSection* find_section(std::string_view label) const;
  MusicSection* find_section(std::string_view label);
  /// @throws ConfigurationError with a suggestion when there is no such section.
  const MusicSection& section(std::string_view label) const;
  MusicSection& section(std::string_view label);
  std::vector<std::string> labels() const;

  /// The key as the section's program sees it: the section's own, else the global one, else null.
  const MusicKey* find_key(const MusicSection& section, std::string_view name) const;
  /// Number of MPI processes of a section.
  /// @throws ConfigurationError when `np` is missing or not a whole number of at least 1.
  int processes(const MusicSection& section) const;
  /// Number of MPI processes of the job. @throws as `processes`.
  int total_processes() const;
};

/// Null when there is no such key.
const MusicKey* find_key(const std::vector<MusicKey>& keys, std::string_view name);
/// Replaces the value, or adds the key at the end.
void set_key(std::vector<MusicKey>& keys, std::string_view name, std::string_view value);

/// Equal when they say the same; locations, paths and warnings do not count.
bool operator==(const MusicKey& a, const MusicKey& b);
bool operator==(const MusicSection& a, const MusicSection& b);
bool operator==(const MusicConnection& a, const MusicConnection& b);
bool operator==(const MusicFile& a, const MusicFile& b);

/// "A.out -> B.in"
std::string describe(const MusicConnection& connection);

/// Parses the text of a file; `path` only names it in locations. Columns count characters.
/// @throws ConfigurationError "file:line:column: what is wrong; what to write".
MusicFile parse_music(std::string_view text, const std::string& path);

/// Reads and parses a file.
/// @throws FileError when it cannot be read, else as `parse_music`.
MusicFile read_music_file(const std::filesystem::path& path);
/// `shown_as` stands for the path in locations.
MusicFile read_music_file(const std::filesystem::path& path, const std::string& shown_as);

/// A file that parses to an equal object, by this parser and by MUSIC's. Comments are not kept.
/// @throws ConfigurationError for an object that no file can say (a line end in a label).
std::string to_text(const MusicFile& file);

/// Puts the locations of `origin` on all that says the same in `file`, which was made from it, and
/// none on the rest: errors then name the lines that a user wrote.
void adopt_locations(MusicFile& file, const MusicFile& origin);

/// Finds what makes MUSIC crash or hang: no application, section without a key, `np` or `binary`
/// missing or wrong, unknown application in a connection, application connected to itself, port
/// used in both directions, two senders to one input, repeated connection, application without
/// connection, width 0, configuration too large for the environment string that carries it. In the
/// order of the file.
Diagnostics structure_diagnostics(const MusicFile& file);

/// @throws ConfigurationError with the first of `structure_diagnostics`.
void check_structure(const MusicFile& file);

/// Whether MUSIC crashes now and then when a spike output has so many connections: 5, 9 to 13,
/// 17 to 29, ... Its IntervalTree then has a node without values.
bool crashes_music(std::size_t connections);
inline constexpr const char* kCrashesMusic =
    "MUSIC crashes now and then with 5, 9 to 13 or 17 to 29";

/// What MUSIC's launcher puts into `_MUSIC_CONFIG_` for an application: label, place, applications,
/// ports, keys. The file must have passed `check_structure`.
std::string music_environment(const MusicFile& file, std::string_view label);

/// Linux passes on no longer environment string ("_MUSIC_CONFIG_=..." and a zero), in bytes.
inline constexpr std::size_t kEnvironmentLimit = 131'072;

}  // namespace spikeloop
